#pragma once
#include "pdx/geom/lattice.hpp"
#include "pdx/pd/bond_kernel.hpp"
#include "pdx/pd/stencil.hpp"

#include <cmath>
#include <random>
#include <vector>

namespace pdx::test {
/// What a random window is made of.
struct WindowOptions {
  double ratio = 3.0; ///< horizon / dx
  law::Micromodulus micromodulus = law::Micromodulus::conical;
  double missing = 0.0; ///< part of the sites that have no particle, in the right third of the window
  double broken = 0.0;  ///< part of the bonds that are broken, in the right third of the window
  bool factors = false; ///< surface factors in [0.5, 2] in the right third of the window, 1 elsewhere
};

/// Row of an interleaved vector.
template <int Dim> Eigen::Map<Vector<Dim>> at(std::vector<double>& x, Index row)
{
  return Eigen::Map<Vector<Dim>>(&x[row * Dim]);
}
template <int Dim> Vector<Dim> at(const std::vector<double>& x, Index row)
{
  return Eigen::Map<const Vector<Dim>>(&x[row * Dim]);
}

/// A padded window of particles with random holes and broken bonds, and its bonds found by looking at all pairs.
/// Entries of sites without a particle are huge: a kernel that lets one in is found out.
template <int Dim> struct Window {
  struct Pair {
    Index i, j;     ///< rows
    Vector<Dim> xi; ///< from i to j [m]
    double kappa, weight;
  };
  static constexpr double kDx = 2.5e-5;
  static constexpr double kNone = 1e30;

  pd::Stencil<Dim> stencil;
  geom::Lattice<Dim> sites; ///< padding included
  std::vector<pd::HalfArm<Dim>> arms;
  std::array<std::vector<std::uint64_t>, 2> words;
  std::vector<std::uint16_t> classes;
  std::vector<double> factors;
  std::vector<std::ptrdiff_t> particles; ///< window index per row
  std::vector<Index> row;                ///< row per window index, -1: no particle
  std::vector<Pair> pairs;
  std::vector<pd::Run> runs;

  Window(const Site<Dim>& count, const WindowOptions& o)
  {
    const law::Elastic elastic{192e9, law::required_poisson(Dim, law::Plane::stress), law::Plane::stress, 1.0};
    stencil = pd::make_stencil<Dim>({kDx, 1.0, o.ratio * kDx, o.micromodulus, pd::Calibration::lattice, elastic});
    sites.dx = kDx;
    for (int d = 0; d < Dim; ++d) sites.count[d] = count[d] + 2 * stencil.reach + (d == 0 ? 16 : 0);
    if (o.factors) draw_factors();
    place_particles(count, o);
    break_bonds(o);
    find_pairs();
    find_runs();
  }

  Index rows() const { return static_cast<Index>(particles.size()); }
  double volume() const { return stencil.volume(); }
  /// Window arrays of a vector with interleaved rows.
  std::array<std::vector<double>, Dim> spread(const std::vector<double>& x) const
  {
    std::array<std::vector<double>, Dim> window;
    for (int d = 0; d < Dim; ++d) {
      window[d].assign(row.size(), kNone);
      for (Index r = 0; r < rows(); ++r) window[d][particles[r]] = x[r * Dim + d];
    }
    return window;
  }
  pd::BondView<Dim> view(const std::array<std::vector<double>, Dim>& u) const
  {
    pd::BondView<Dim> v;
    for (int d = 0; d < Dim; ++d) v.u[d] = u[d].data();
    v.words = {words[0].data(), words[1].data()};
    v.classes = classes.empty() ? nullptr : classes.data();
    v.factors = factors.data();
    v.arms = arms;
    return v;
  }
  std::vector<double> random_vector(double size, unsigned seed) const
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-size, size);
    std::vector<double> x(static_cast<std::size_t>(rows()) * Dim);
    for (double& v : x) v = uniform(random);
    return x;
  }

private:
  std::mt19937 random_{12345};
  double chance() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  bool at_right(std::ptrdiff_t index) const { return 3 * sites.site(index)[0] > 2 * (sites.count[0] - 16); }

  static constexpr std::uint16_t kClasses = 9; // 0: factors 1; the last one: of no particle
  void draw_factors()
  {
    factors.assign(stencil.half.size(), 1.0);
    while (factors.size() < kClasses * stencil.half.size()) factors.push_back(0.5 + 1.5 * chance());
    factors.resize(factors.size() + stencil.half.size(), kNone);
    classes.assign(static_cast<std::size_t>(sites.total()), kClasses);
  }
  void place_particles(const Site<Dim>& count, const WindowOptions& o)
  {
    const std::size_t size = static_cast<std::size_t>(sites.total());
    row.assign(size, -1);
    for (std::size_t index = 0; index < size; ++index) {
      Site<Dim> s = sites.site(static_cast<std::int64_t>(index));
      bool inside = true;
      for (int d = 0; d < Dim; ++d) inside = inside && s[d] >= stencil.reach && s[d] < stencil.reach + count[d];
      if (!inside || (at_right(index) && chance() < o.missing)) continue;
      row[index] = rows();
      particles.push_back(static_cast<std::ptrdiff_t>(index));
      if (o.factors) classes[index] = at_right(index) ? static_cast<std::uint16_t>(kClasses * chance()) : 0;
    }
  }
  void break_bonds(const WindowOptions& o)
  {
    for (auto& plane : words) plane.assign(row.size(), 0);
    for (const auto& arm : stencil.half)
      arms.push_back({static_cast<std::ptrdiff_t>(sites.number(arm.step)), {}, arm.length, arm.kappa});
    for (std::size_t h = 0; h < arms.size(); ++h) {
      for (int d = 0; d < Dim; ++d) arms[h].xi[d] = stencil.half[h].xi[d];
      for (const std::ptrdiff_t i : particles)
        if (row[i + arms[h].jump] >= 0 && !(at_right(i) && chance() < o.broken))
          words[h / 64][i] |= std::uint64_t{1} << (h % 64);
    }
  }
  void find_pairs()
  {
    std::vector<Site<Dim>> site;
    for (const std::ptrdiff_t index : particles) site.push_back(sites.site(index));
    for (Index i = 0; i < rows(); ++i)
      for (Index j = 0; j < rows(); ++j) {
        const Site<Dim>&a = site[i], &b = site[j];
        for (std::size_t h = 0; h < arms.size(); ++h) {
          bool joined = true;
          for (int d = 0; d < Dim; ++d) joined = joined && b[d] - a[d] == stencil.half[h].step[d];
          if (!joined || !(words[h / 64][particles[i]] >> (h % 64) & 1)) continue;
          const double factor = classes.empty() ? 1.0 : factors[classes[particles[i]] * arms.size() + h];
          pairs.push_back({i, j, sites.point(b) - sites.point(a), stencil.half[h].kappa, factor});
        }
      }
  }
  /// Longest runs of one kind.
  void find_runs()
  {
    std::vector<std::size_t> plain(particles.size(), 0);
    for (const Pair& pair : pairs)
      if (pair.weight == 1.0) ++plain[pair.i], ++plain[pair.j];
    for (Index r = 0; r < rows(); ++r) {
      const auto kind = plain[r] == 2 * arms.size() ? pd::RunKind::whole : pd::RunKind::partial;
      const bool on = !runs.empty() && runs.back().kind == kind && particles[r] == particles[r - 1] + 1;
      if (on)
        ++runs.back().length;
      else
        runs.push_back({particles[r], r, 1, kind});
    }
  }
};
} // namespace pdx::test
