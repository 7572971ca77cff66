#include "pdx/base/gather.hpp"
#include "pdx/pd/bond_term.hpp"
#include "support/ranks.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <set>

using namespace pdx;
using crack::CrackSet;
using law::Kinematics;

using pdx::test::rank;
using pdx::test::ranks;

namespace {
constexpr Index kWide = 21, kHigh = 18;
constexpr double kDx = 0.25;

geom::Lattice<2> lattice() { return {{1.0, 2.0}, kDx, {kWide, kHigh}}; }
Vector<2> point(Index site) { return lattice().point(lattice().site(site)); }

pd::Stencil<2> stencil(double ratio)
{
  pd::StencilOptions options;
  options.dx = kDx;
  options.horizon = ratio * kDx;
  options.elastic = {3.0, 1.0 / 3.0, law::Plane::stress, 1.0};
  return pd::make_stencil<2>(options);
}

template <class T> T sum(T mine)
{
  const std::vector<T> all = gather_all<T>(PETSC_COMM_WORLD, {mine});
  T total{};
  for (const T& x : all) total += x;
  return total;
}

/// Stripes with single sites of others strewn in.
int owner(Index site) { return site % 11 == 3 ? site / 11 % ranks() : (site % kWide / 3 + site / kWide / 5) % ranks(); }

using Pair = std::pair<Index, Index>; ///< sites, lower number first
using Field = std::function<Vector<2>(const Vector<2>&)>;

/// Wavy, and opens about x = 3.4 with stretches up to some per cent there.
Vector<2> opening(const Vector<2>& x)
{
  const double open = 0.02 * std::tanh(8.0 * (x.x() - 3.4)) * std::cos(x.y() - 3.0);
  return {open + 0.003 * std::sin(5.0 * x.y()), 0.004 * std::cos(4.0 * x.x())};
}

/// All that a rank has of the patch, and the bonds of the whole patch by looking at all pairs of sites.
struct Patch {
  pd::Stencil<2> arms;
  std::vector<Index> sites;
  field::Rows rows;
  std::unique_ptr<field::RowHalo> halo;
  std::unique_ptr<pd::BondTerm<2>> term;
  std::set<Pair> bonds;             ///< intact ones, kept by the test
  std::map<Pair, double> stiffness; ///< kappa by step; both halves [N]

  explicit Patch(Kinematics kinematics = Kinematics::small, bool assembled = false, double ratio = 4.0,
                 const pd::Exists<2>& exists = {})
      : arms(stencil(ratio))
  {
    for (Index site = 0; site < kWide * kHigh; ++site)
      if (owner(site) == rank()) sites.push_back(site);
    rows = field::Rows::number(PETSC_COMM_WORLD, 2, 1 + rank(), 0, static_cast<Index>(sites.size()));
    std::vector<std::unique_ptr<pd::LatticePart<2>>> parts;
    parts.push_back(std::make_unique<pd::LatticePart<2>>(rows, lattice(), arms, sites, 1 + rank(),
                                                         exists ? pd::correct_volumes<2>(arms, exists) : nullptr));
    term = std::make_unique<pd::BondTerm<2>>(std::move(parts), kinematics, assembled);
    std::vector<PetscInt> needed;
    term->needed_rows(needed);
    halo = std::make_unique<field::RowHalo>(rows, needed);
    term->bind(*halo);
    for (const auto& arm : arms.half)
      for (const int sign : {1, -1}) stiffness[{sign * arm.step[0], sign * arm.step[1]}] = arm.kappa;
    for (Index i = 0; i < kWide * kHigh; ++i)
      for (Index j = i + 1; j < kWide * kHigh; ++j)
        if (stiffness.contains(step(i, j))) bonds.insert({i, j});
  }

  pd::LatticePart<2>& part() { return *term->parts().front(); }
  static Pair step(Index i, Index j) { return {j % kWide - i % kWide, j / kWide - i / kWide}; }

  std::vector<double> blocks(const Field& u) const
  {
    std::vector<double> owned(static_cast<std::size_t>(2 * rows.first_particle()), -1e6), all;
    for (const Index site : sites) {
      const Vector<2> value = u(point(site));
      owned.insert(owned.end(), {value.x(), value.y()});
    }
    halo->fetch(owned, 2, all);
    return all;
  }

  pd::Broken break_at(const Field& u, const pd::BreakRule& rule)
  {
    const auto values = blocks(u);
    return term->break_bonds(term->load(values), {&rule, 1});
  }

  /// Takes the bonds out of `bonds` for which `gone` is true, and returns how many.
  std::int64_t expect_gone(const std::function<bool(Index, Index)>& gone)
  {
    return static_cast<std::int64_t>(std::erase_if(bonds, [&](const Pair& b) { return gone(b.first, b.second); }));
  }

  /// The bonds of owned particles are those of `bonds`, seen from either end, and words, counts and runs agree.
  void check_bonds()
  {
    std::size_t seen = 0, expected = 0;
    for (std::size_t k = 0; k < sites.size(); ++k) {
      part().for_each_bond(static_cast<Index>(k), [&](std::size_t, int, const Site<2>& other, double) {
        const auto j = static_cast<Index>(lattice().number(other));
        EXPECT_TRUE(bonds.contains(std::minmax(sites[k], j))) << sites[k] << " to " << j;
        ++seen;
      });
      const auto words = part().words_of(static_cast<Index>(k));
      for (std::size_t h = 0; h < arms.half.size(); ++h) {
        Site<2> other = lattice().site(sites[k]);
        for (std::size_t d = 0; d < 2; ++d) other[d] += arms.half[h].step[d];
        const bool there =
            lattice().contains(other) && bonds.contains({sites[k], static_cast<Index>(lattice().number(other))});
        EXPECT_EQ(words[h / 64] >> h % 64 & 1u, there);
      }
    }
    for (const auto& [i, j] : bonds) expected += (owner(i) == rank()) + (owner(j) == rank());
    EXPECT_EQ(seen, expected);
    EXPECT_EQ(sum(term->bonds()), static_cast<std::int64_t>(bonds.size()));
  }

  double factor(Index i, Index j, const std::vector<double>& q) const
  {
    return q.empty() ? 1.0 : 2.0 / (q[static_cast<std::size_t>(i)] + q[static_cast<std::size_t>(j)]);
  }

  /// Force of the bonds in `bonds` on every site, linear.
  std::map<Index, Vector<2>> force(const Field& u, const std::vector<double>& q = {}) const
  {
    std::map<Index, Vector<2>> result;
    for (Index i = 0; i < kWide * kHigh; ++i) result[i] = Vector<2>::Zero();
    for (const auto& [i, j] : bonds) {
      const Vector<2> xi = point(j) - point(i), eta = u(point(j)) - u(point(i));
      const Vector<2> pull = factor(i, j, q) * stiffness.at(step(i, j)) / std::pow(xi.norm(), 3) * xi.dot(eta) * xi;
      result[i] -= pull;
      result[j] += pull;
    }
    return result;
  }

  /// add_residual, and the tangent's action with its diagonal, against `force`.
  void check_forces(const Field& u, const std::vector<double>& q = {})
  {
    const auto values = blocks(u);
    std::vector<double> r(static_cast<std::size_t>(2 * rows.owned()), 0.0);
    term->add_residual(values, r);
    const auto expected = force(u, q);
    double size = 0.0;
    for (const auto& [site, f] : expected) size = std::max(size, f.norm());
    for (std::size_t k = 0; k < sites.size(); ++k)
      for (Index d = 0; d < 2; ++d)
        EXPECT_NEAR(r[2 * (static_cast<std::size_t>(rows.first_particle()) + k) + static_cast<std::size_t>(d)],
                    expected.at(sites[k])[d], 1e-12 * size);
    double energy = 0.0;
    for (const auto& [site, f] : expected) energy += 0.5 * f.dot(u(point(site)));
    EXPECT_NEAR(sum(term->energy(values)), energy, 1e-11 * std::abs(energy));
  }
};

/// s of a bond under a displacement, by lengths.
double stretch(const Field& u, Index i, Index j, Kinematics kinematics)
{
  const Vector<2> xi = point(j) - point(i), eta = u(point(j)) - u(point(i));
  return kinematics == Kinematics::small ? xi.dot(eta) / xi.squaredNorm() : (xi + eta).norm() / xi.norm() - 1.0;
}

CrackSet slanted()
{
  return CrackSet({{{0.9, 3.13}, {3.4, 4.02}, {4.6, 3.3}}, {{5.01, 2.0}, {4.3, 6.6}}},
                  geom::Box<2>{{1.0, 2.0}, {6.25, 6.5}});
}

MatHandle matrix(field::Rows& rows, const field::RowHalo& halo, const pd::BondTerm<2>& term, bool whole)
{
  field::Couplings couplings(halo);
  term.couplings(couplings, whole);
  for (PetscInt& n : couplings.diagonal) n = std::min(n + 1, rows.owned());
  for (PetscInt& n : couplings.off_diagonal) n = std::min(n, rows.total - rows.owned());
  MatHandle m;
  PDX_CALL(MatCreate(rows.comm, m.out()));
  PDX_CALL(MatSetSizes(m.get(), 2 * rows.owned(), 2 * rows.owned(), PETSC_DETERMINE, PETSC_DETERMINE));
  PDX_CALL(MatSetBlockSize(m.get(), 2));
  PDX_CALL(MatSetType(m.get(), MATAIJ));
  PDX_CALL(
      MatXAIJSetPreallocation(m.get(), 2, couplings.diagonal.data(), couplings.off_diagonal.data(), nullptr, nullptr));
  const std::vector<std::uint8_t> held(static_cast<std::size_t>(2 * halo.size()), 0);
  field::BlockAdder adder(m.get(), halo, held);
  term.add_jacobian(adder, whole);
  adder.finish(1.0);
  return m;
}

/// The tangent at u applied to x: matrix times x plus what acts without a matrix.
std::vector<double> tangent_times(Patch& patch, const Field& u, const Field& x, bool whole)
{
  const auto at = patch.blocks(u), direction = patch.blocks(x);
  const auto size = static_cast<std::size_t>(2 * patch.rows.owned());
  patch.term->linearise(at);
  const MatHandle m = matrix(patch.rows, *patch.halo, *patch.term, whole);
  VecHandle vx = patch.rows.vector(), vy = patch.rows.vector();
  double* values = nullptr;
  PDX_CALL(VecGetArray(vx.get(), &values));
  std::copy_n(direction.begin(), size, values);
  PDX_CALL(VecRestoreArray(vx.get(), &values));
  PDX_CALL(MatMult(m.get(), vx.get(), vy.get()));
  PDX_CALL(VecGetArray(vy.get(), &values));
  std::vector<double> y(values, values + size);
  PDX_CALL(VecRestoreArray(vy.get(), &values));
  if (!whole) patch.term->add_tangent_action({direction.data(), size}, y);
  y.erase(y.begin(), y.begin() + 2 * patch.rows.first_particle());
  return y;
}
} // namespace

TEST(BrokenBonds, CutBondsAreThoseThatACrackParts)
{
  for (const double ratio : {4.0, 6.6}) { // one and two words
    Patch patch(Kinematics::small, false, ratio);
    const CrackSet cracks = slanted();
    const std::int64_t cut = sum(patch.term->cut(cracks));
    EXPECT_EQ(cut, patch.expect_gone([&](Index i, Index j) { return cracks.cuts(point(i), point(j)); }));
    EXPECT_GT(cut, 100);
    patch.check_bonds();
    patch.check_forces(opening);
  }
}

TEST(BrokenBonds, ABreakPassTakesOutWhatIsOverstretched)
{
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite})
    for (const double ratio : {4.0, 6.6}) {
      Patch patch(kinematics, false, ratio);
      constexpr double s0 = 0.02;
      std::vector<double> ratios;
      const pd::BreakRule rule{kinematics, s0, nullptr};
      const auto values = patch.blocks(opening);
      patch.term->overstretched(patch.term->load(values), {&rule, 1}, ratios);
      const pd::Broken broken = patch.break_at(opening, rule);
      double energy = 0.0, largest = 0.0;
      const std::int64_t expected = patch.expect_gone([&](Index i, Index j) {
        const double s = stretch(opening, i, j, kinematics);
        if (s <= s0) return false;
        energy += 0.5 * patch.stiffness.at(Patch::step(i, j)) * s * s * (point(j) - point(i)).norm();
        largest = std::max(largest, s / s0);
        return true;
      });
      EXPECT_EQ(sum(broken.bonds), expected);
      EXPECT_EQ(sum(static_cast<std::int64_t>(ratios.size())), expected);
      EXPECT_GT(expected, 50);
      EXPECT_NEAR(sum(broken.energy), energy, 1e-11 * energy);
      double most = 0.0;
      for (const double r : gather_all(PETSC_COMM_WORLD, ratios)) most = std::max(most, r);
      EXPECT_NEAR(most, largest, 1e-11 * largest);
      patch.check_bonds();
      if (kinematics == Kinematics::small) patch.check_forces(opening);
      EXPECT_EQ(sum(patch.break_at(opening, rule).bonds), 0);
    }
}

TEST(BrokenBonds, SurfaceFactorsStayWithTheBondsThatAreLeft)
{
  const pd::Exists<2> exists = [](const Site<2>& site) { return lattice().contains(site); };
  Patch patch(Kinematics::small, false, 4.0, exists);
  std::vector<double> q;
  for (Index site = 0; site < kWide * kHigh; ++site)
    q.push_back(pd::family_share<2>(patch.arms, lattice().site(site), exists));
  const CrackSet cracks = slanted();
  patch.term->cut(cracks);
  patch.expect_gone([&](Index i, Index j) { return cracks.cuts(point(i), point(j)); });
  double energy = 0.0;
  const pd::Broken broken = patch.break_at(opening, {Kinematics::small, 0.02, nullptr});
  patch.expect_gone([&](Index i, Index j) {
    const double s = stretch(opening, i, j, Kinematics::small);
    if (s <= 0.02) return false;
    const double length = (point(j) - point(i)).norm();
    energy += 0.5 * patch.factor(i, j, q) * patch.stiffness.at(Patch::step(i, j)) * s * s * length;
    return true;
  });
  EXPECT_NEAR(sum(broken.energy), energy, 1e-11 * energy);
  patch.check_forces(opening, q);
}

TEST(BrokenBonds, TheTangentWithoutAMatrixIsTheAssembledOne)
{
  const Field x = [](const Vector<2>& p) { return Vector<2>(std::sin(7.0 * p.x() + p.y()), std::cos(9.0 * p.y())); };
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite}) {
    Patch free(kinematics, false), whole(kinematics, true);
    for (Patch* patch : {&free, &whole}) {
      patch->term->cut(slanted());
      EXPECT_GT(sum(patch->break_at(opening, {kinematics, 0.02, nullptr}).bonds), 50);
    }
    const auto a = tangent_times(free, opening, x, false), b = tangent_times(whole, opening, x, true);
    double size = 0.0;
    for (const double v : b) size = std::max(size, std::abs(v));
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], 1e-12 * size);
    if (kinematics == Kinematics::finite) continue;
    free.expect_gone([&](Index i, Index j) { return slanted().cuts(point(i), point(j)); });
    free.expect_gone([&](Index i, Index j) { return stretch(opening, i, j, kinematics) > 0.02; });
    const auto force = free.force(x);
    for (std::size_t k = 0; k < free.sites.size(); ++k)
      for (Index d = 0; d < 2; ++d)
        EXPECT_NEAR(a[2 * k + static_cast<std::size_t>(d)], force.at(free.sites[k])[d], 1e-12 * size);
  }
}

TEST(BrokenBonds, RestoreGivesTheSameForcesToTheLastBit)
{
  Patch patch(Kinematics::finite);
  const auto values = patch.blocks(opening);
  const auto force = [&] {
    std::vector<double> r(static_cast<std::size_t>(2 * patch.rows.owned()), 0.0);
    patch.term->add_residual(values, r);
    return r;
  };
  patch.term->cut(slanted());
  patch.break_at(opening, {Kinematics::finite, 0.03, nullptr});
  patch.term->save();
  const auto before = force();
  const std::int64_t bonds = patch.term->bonds();
  const pd::BreakRule rule{Kinematics::finite, 0.015, nullptr};
  std::vector<double> broken;
  for (int again = 0; again < 2; ++again) {
    EXPECT_GT(sum(patch.break_at(opening, rule).bonds), 0);
    if (again) {
      EXPECT_EQ(force(), broken);
    }
    broken = force();
    patch.term->restore();
    EXPECT_EQ(force(), before);
    EXPECT_EQ(patch.term->bonds(), bonds);
  }
}

TEST(BrokenBonds, NothingFailsInANoFailBox)
{
  Patch patch;
  const geom::Box<2> box{{2.9, 3.0}, {4.1, 4.1}};
  patch.term->protect({&box, 1});
  patch.break_at(opening, {Kinematics::small, 0.01, nullptr});
  const std::int64_t spared =
      static_cast<std::int64_t>(std::count_if(patch.bonds.begin(), patch.bonds.end(), [&](const Pair& b) {
        return stretch(opening, b.first, b.second, Kinematics::small) > 0.01 &&
               (box.contains(point(b.first)) || box.contains(point(b.second)));
      }));
  EXPECT_GT(spared, 50);
  patch.expect_gone([&](Index i, Index j) {
    return stretch(opening, i, j, Kinematics::small) > 0.01 && !box.contains(point(i)) && !box.contains(point(j));
  });
  patch.check_bonds();
  const CrackSet cracks = slanted(); // a precrack goes through all the same
  patch.term->cut(cracks);
  patch.expect_gone([&](Index i, Index j) { return cracks.cuts(point(i), point(j)); });
  patch.check_bonds();
}

TEST(BrokenBonds, OnlyParticlesThatMayBeLooseAreWeak)
{
  Patch patch;
  std::vector<Index> weak;
  patch.term->weak_rows(weak);
  EXPECT_TRUE(weak.empty());
  // A row of particles between two cracks hangs on bonds along x only; one particle is cut out of the lattice.
  const double y = 2.0 + 6 * kDx, a = 1.0 + 15 * kDx, b = 2.0 + 12 * kDx;
  patch.term->cut(CrackSet({{{0.9, y}, {6.3, y}},
                            {{0.9, y + kDx}, {6.3, y + kDx}},
                            {{a, b}, {a + kDx, b}, {a + kDx, b + kDx}, {a, b + kDx}, {a - 1e-3, b - 1e-3}}},
                           geom::Box<2>{{1.0, 2.0}, {6.25, 6.5}}));
  patch.term->weak_rows(weak);
  std::set<Index> expected, found;
  for (std::size_t k = 0; k < patch.sites.size(); ++k)
    if (patch.sites[k] / kWide == 6 || patch.sites[k] == 12 * kWide + 15)
      expected.insert(patch.rows.first_particle() + static_cast<Index>(k));
  found.insert(weak.begin(), weak.end());
  EXPECT_EQ(found, expected);
}
