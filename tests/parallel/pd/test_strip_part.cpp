#include "pdx/pd/bond_term.hpp"
#include "support/ranks.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <set>
#include <tuple>

namespace pdx::test::strip_part {
using law::Kinematics;

namespace {
constexpr double kDx = 0.25;

std::vector<Processor> processors()
{
  std::vector<Processor> list{Processor::any};
  for (const Processor p : {Processor::avx2, Processor::avx512})
    if (p <= this_processor()) list.push_back(p);
  return list;
}

/// What a patch is made of.
template <int Dim> struct Options {
  Site<Dim> count{};
  double ratio = 4.0;
  law::Micromodulus micromodulus = law::Micromodulus::conical;
  Kinematics kinematics = Kinematics::finite;
  bool shares = false;
  crack::CrackSet precrack = {};
};

/// Owners of sites: an L around a block with two ranks, with three the rest in strewn stripes.
template <int Dim> int owner(const geom::Lattice<Dim>& lattice, Index number)
{
  const Site<Dim> s = lattice.site(number);
  if (ranks() == 1) return 0;
  if (3 * s[0] > lattice.count[0] && 2 * s[Dim - 1] > lattice.count[Dim - 1]) return 1;
  return ranks() > 2 && (s[0] / 3 + s[1]) % 5 == 0 ? 2 : 0;
}

/// One patch, half of its rows in front left to others.
template <int Dim> struct Patch {
  geom::Lattice<Dim> lattice;
  std::vector<Index> sites;
  field::Rows rows;
  pd::LatticePart<Dim>* part = nullptr;
  std::unique_ptr<pd::BondTerm<Dim>> term;
  std::unique_ptr<field::RowHalo> halo;

  explicit Patch(const Options<Dim>& o)
  {
    lattice.dx = kDx;
    lattice.count = o.count;
    pd::StencilOptions options;
    options.dx = kDx;
    options.horizon = o.ratio * kDx;
    options.micromodulus = o.micromodulus;
    options.elastic = {3.0, law::required_poisson(Dim, law::Plane::stress), law::Plane::stress, 1.0};
    for (Index site = 0; site < lattice.total(); ++site)
      if (owner(lattice, site) == rank()) sites.push_back(site);
    rows = field::Rows::number(PETSC_COMM_WORLD, 2, 1 + rank(), 0, static_cast<Index>(sites.size()));
    pd::SurfaceCorrection<Dim> correction;
    if (o.shares)
      correction = pd::correct_volumes<Dim>(pd::make_stencil<Dim>(options),
                                            [this](const Site<Dim>& site) { return lattice.contains(site); });
    std::vector<std::unique_ptr<pd::LatticePart<Dim>>> parts;
    parts.push_back(std::make_unique<pd::LatticePart<Dim>>(rows, lattice, pd::make_stencil<Dim>(options), sites,
                                                           1 + rank(), correction));
    part = parts.front().get();
    term = std::make_unique<pd::BondTerm<Dim>>(std::move(parts), o.kinematics, false);
    std::vector<PetscInt> none;
    halo = std::make_unique<field::RowHalo>(rows, none);
    term->bind(*halo);
    term->cut(o.precrack);
  }

  using Field = std::function<Vector<Dim>(const Vector<Dim>&)>;
  std::vector<double> owned(const Field& u) const
  {
    std::vector<double> values(static_cast<std::size_t>(rows.owned()) * Dim, -7.0);
    for (std::size_t k = 0; k < sites.size(); ++k) {
      const Vector<Dim> x = u(lattice.point(lattice.site(sites[k])));
      for (int d = 0; d < Dim; ++d)
        values[(static_cast<std::size_t>(part->first_row()) + k) * Dim + std::size_t(d)] = x[d];
    }
    return values;
  }
  std::vector<double> force(const std::vector<double>& u, double start = 0.0) const
  {
    std::vector<double> r(u.size(), start);
    term->add_residual(u, r);
    return r;
  }
  /// Bonds of this rank's particles: site, half arm, direction.
  std::set<std::tuple<Index, std::size_t, int>> bonds() const
  {
    std::set<std::tuple<Index, std::size_t, int>> all;
    for (std::size_t k = 0; k < sites.size(); ++k)
      part->for_each_bond(static_cast<Index>(k),
                          [&](std::size_t h, int sign, const Site<Dim>&, double) { all.emplace(sites[k], h, sign); });
    return all;
  }
};

/// Waves of relative size `size` without a pattern.
template <int Dim> typename Patch<Dim>::Field waves(double size)
{
  return [size](const Vector<Dim>& x) {
    Vector<Dim> u;
    for (int d = 0; d < Dim; ++d)
      u[d] = size * kDx *
             (std::sin(5.0 * x.sum() + d) + std::cos(17.0 * x[d] * x[(d + 1) % Dim]) + std::sin(91.0 * x[0] - d));
    return u;
  };
}

/// The static force of the same patch, and what `add_residual` of lane strips makes of it.
template <int Dim> void expect_static_force(const Options<Dim>& o, double size)
{
  const Patch<Dim> reference(o);
  const std::vector<double> u = reference.owned(waves<Dim>(size)), expected = reference.force(u);
  double scale = 0.0;
  for (const double f : expected) scale = std::max(scale, std::abs(f));
  scale = largest(scale);
  ASSERT_GT(scale, 0.0);
  const double energy = sum(reference.term->energy(u));
  for (const Processor processor : processors()) {
    SCOPED_TRACE(lanes_of(processor));
    Patch<Dim> patch(o);
    patch.term->step_explicitly({}, processor);
    for (int pass = 0; pass < 2; ++pass) { // the second one knows how far bonds are stretched
      const std::vector<double> r = patch.force(u);
      double worst = 0.0, total = 0.0;
      for (std::size_t k = 0; k < r.size(); ++k) {
        worst = std::max(worst, std::abs(r[k] - expected[k]));
        total += r[k];
      }
      EXPECT_LT(worst, 1e-14 * scale);
      EXPECT_NEAR(sum(total), 0.0, 1e-11 * scale);
      EXPECT_NEAR(sum(patch.term->energy(u)), energy, 1e-13 * energy);
    }
    EXPECT_FALSE(patch.term->overstretched_seen());
    EXPECT_EQ(patch.term->tiles_skipped(), 0);
  }
}

crack::CrackSet slit(double width, double height)
{
  return crack::CrackSet({{{0.0, 0.53 * height}, {0.4 * width, 0.47 * height}}},
                         geom::Box<2>{{0.0, 0.0}, {width, height}});
}

TEST(StripPart, ForcesAreThoseOfTheStaticKernel)
{
  for (const auto kinematics : {Kinematics::small, Kinematics::finite})
    for (const bool shares : {false, true})
      for (const double size : {1e-5, 5e-4, 2e-3, 1e-2, 5e-2}) { // all series, and the root
        SCOPED_TRACE(testing::Message() << "finite " << int(kinematics == Kinematics::finite) << " shares " << shares
                                        << " size " << size);
        Options<2> o{{203, 77}};
        o.kinematics = kinematics;
        o.shares = shares;
        o.precrack = slit(203 * kDx, 77 * kDx);
        expect_static_force<2>(o, size);
      }
}

TEST(StripPart, ForcesOfOtherStencilsAndSizes)
{
  Options<2> o{{64, 33}, 3.015, law::Micromodulus::uniform};
  expect_static_force<2>(o, 1e-3);
  o = {{31, 40}, 6.5, law::Micromodulus::uniform}; // two words, strips shorter than the reach
  expect_static_force<2>(o, 1e-3);
  o = {{9, 5}, 2.0};
  expect_static_force<2>(o, 1e-2);
}

TEST(StripPart, ForcesInSpace)
{
  for (const auto kinematics : {Kinematics::small, Kinematics::finite}) {
    Options<3> o{{23, 11, 13}, 3.015, law::Micromodulus::uniform, kinematics};
    expect_static_force<3>(o, 1e-3);
    o.shares = true;
    o.precrack = slit(23 * kDx, 11 * kDx);
    expect_static_force<3>(o, 4e-2);
  }
  expect_static_force<3>({{14, 12, 10}, 3.7, law::Micromodulus::conical}, 1e-3); // two words
}

/// Opens across x = 0.55 width by up to 6 %, with waves everywhere.
template <int Dim> typename Patch<Dim>::Field opening(double width)
{
  return [width, wave = waves<Dim>(2e-3)](const Vector<Dim>& x) -> Vector<Dim> {
    Vector<Dim> u = wave(x);
    u[0] += 0.04 * kDx * std::tanh(3.0 * (x[0] - 0.55 * width) / kDx) * std::cos(0.9 * x[1]);
    return u;
  };
}

/// Both ways of breaking the same bonds, twice at growing displacement.
template <int Dim> void expect_same_broken(Options<Dim> o)
{
  const double width = o.count[0] * kDx, height = o.count[1] * kDx;
  const std::vector<geom::Box<2>> zones{{{0.5 * width, 0.0}, {0.6 * width, 0.2 * height}}};
  for (const Processor processor : processors()) {
    SCOPED_TRACE(lanes_of(processor));
    Patch<Dim> reference(o), patch(o);
    for (Patch<Dim>* p : {&reference, &patch}) p->term->protect(zones);
    const pd::BreakRule rule{o.kinematics, 0.011};
    patch.term->step_explicitly({&rule, 1}, processor);
    for (const double scale : {1.0, 1.4}) {
      std::vector<double> u = patch.owned(opening<Dim>(width));
      for (double& x : u) x *= scale;
      const pd::Broken expected = reference.term->break_bonds(reference.term->load(u), {&rule, 1});
      patch.force(u);
      EXPECT_TRUE(largest(patch.term->overstretched_seen()) > 0.0);
      const pd::Broken broken = patch.term->break_overstretched();
      EXPECT_FALSE(patch.term->overstretched_seen());
      EXPECT_EQ(broken.bonds, expected.bonds);
      EXPECT_NEAR(broken.energy, expected.energy, 1e-12 * expected.energy);
      EXPECT_GT(sum(static_cast<double>(broken.bonds)), 100.0);
      EXPECT_EQ(patch.bonds(), reference.bonds());
      std::vector<double> after = patch.force(u), other = reference.force(u);
      double apart = 0.0, size = 0.0;
      for (std::size_t k = 0; k < after.size(); ++k) {
        apart = std::max(apart, std::abs(after[k] - other[k]));
        size = std::max(size, std::abs(other[k]));
      }
      EXPECT_LT(apart, 1e-14 * largest(size));
      EXPECT_EQ(patch.term->break_overstretched().bonds, 0); // once
    }
  }
}

TEST(StripPart, BreaksTheBondsOfTheStaticWay)
{
  for (const auto kinematics : {Kinematics::small, Kinematics::finite}) {
    Options<2> o{{90, 50}};
    o.kinematics = kinematics;
    o.precrack = slit(90 * kDx, 50 * kDx);
    expect_same_broken<2>(o);
    o.shares = true;
    expect_same_broken<2>(o);
    expect_same_broken<3>({{24, 11, 9}, 3.015, law::Micromodulus::uniform, kinematics});
  }
}

TEST(StripPart, SeesNothingWhereNothingIsOverstretched)
{
  Patch<2> patch(Options<2>{{90, 50}});
  // stretched by just less than allowed, then by just more, and turned by 0.3 rad
  for (const double excess : {-1e-9, 1e-9}) {
    const double s0 = 1e-3, c = std::cos(0.3), s = std::sin(0.3), grown = 1.0 + s0 * (1.0 + excess);
    const pd::BreakRule rule{Kinematics::finite, s0};
    patch.term->step_explicitly({&rule, 1});
    const std::vector<double> u = patch.owned([&](const Vector<2>& x) {
      return Vector<2>(grown * (c * x[0] - s * x[1]) - x[0], grown * (s * x[0] + c * x[1]) - x[1]);
    });
    patch.force(u);
    EXPECT_EQ(patch.term->overstretched_seen(), excess > 0.0);
    EXPECT_EQ(patch.term->break_overstretched().bonds > 0, excess > 0.0);
  }
}

TEST(StripPart, SqueezedBondsAreNoReasonToLook)
{
  Patch<2> patch(Options<2>{{60, 30}});
  const pd::BreakRule rule{Kinematics::finite, 1e-3};
  patch.term->step_explicitly({&rule, 1});
  patch.force(patch.owned([](const Vector<2>& x) -> Vector<2> { return -0.02 * x; }));
  EXPECT_FALSE(patch.term->overstretched_seen());
}

/// A few explicit steps from a point pulse; `at_rest` as in StripPart::skip_below.
std::vector<double> pulse(pd::StripPart<2>& strip, const Patch<2>& patch, int steps, double at_rest)
{
  strip.skip_below(at_rest);
  std::vector<double> u = patch.owned([](const Vector<2>& x) -> Vector<2> {
    return (x - Vector<2>(10.1, 11.1)).norm() < 0.3 ? Vector<2>(1e-3, 2e-3) : Vector<2>(0.0, 0.0);
  });
  const std::size_t front = static_cast<std::size_t>(patch.rows.first_particle()) * 2;
  std::fill_n(u.begin(), front, 0.0);
  std::vector<double> v(u.size(), 0.0), r(u.size());
  for (int step = 0; step < steps; ++step) {
    std::fill(r.begin(), r.end(), 0.0);
    strip.load(u);
    strip.add_force(r.data());
    for (std::size_t k = front; k < u.size(); ++k) {
      v[k] -= 0.05 * r[k];
      u[k] += v[k];
    }
  }
  return u;
}

TEST(StripPart, SkippedTilesChangeNoBit)
{
  const Patch<2> patch(Options<2>{{403, 97}});
  for (const Processor processor : processors()) {
    pd::StripPart<2> all(*patch.part, Kinematics::finite, processor), some(*patch.part, Kinematics::finite, processor);
    const std::vector<double> expected = pulse(all, patch, 6, -1.0), u = pulse(some, patch, 6, 0.0);
    EXPECT_EQ(std::memcmp(u.data(), expected.data(), u.size() * sizeof(double)), 0);
    EXPECT_EQ(all.tiles_skipped(), 0);
    EXPECT_EQ(some.tiles_computed() + some.tiles_skipped(), all.tiles_computed());
    const double computed = sum(static_cast<double>(some.tiles_computed()));
    EXPECT_GT(computed, 0.0);
    if (ranks() == 1) {
      EXPECT_GT(some.tiles_skipped(), some.tiles_computed() / 4);
    }
  }
}

TEST(StripPart, CountsTilesAtRest)
{
  const Patch<2> patch(Options<2>{{376, 152}});
  pd::StripPart<2> strip(*patch.part, Kinematics::finite);
  strip.load(std::vector<double>(static_cast<std::size_t>(patch.rows.owned()) * 2, 0.0));
  std::vector<double> r(static_cast<std::size_t>(patch.rows.owned()) * 2, -0.0);
  strip.add_force(r.data());
  EXPECT_EQ(strip.tiles_computed(), 0);
  for (const double x : r) EXPECT_TRUE(x == 0.0 && std::signbit(x)); // not even touched
  strip.load(patch.owned([](const Vector<2>&) { return Vector<2>(1e-3, 0.0); }));
  strip.add_force(r.data());
  EXPECT_EQ(strip.tiles_computed(), strip.tiles_skipped());
}

TEST(StripPart, TakesOverWhatWasRestored)
{
  Patch<2> patch(Options<2>{{60, 30}});
  patch.term->save();
  const pd::BreakRule rule{Kinematics::finite, 0.011};
  patch.term->step_explicitly({&rule, 1});
  const std::vector<double> u = patch.owned(opening<2>(60 * kDx)), before = patch.force(u);
  const auto bonds = patch.bonds();
  EXPECT_GT(sum(static_cast<double>(patch.term->break_overstretched().bonds)), 0.0);
  EXPECT_GT(sum(patch.force(u) != before), 0.0);
  patch.term->restore();
  EXPECT_EQ(patch.force(u), before);
  EXPECT_EQ(patch.bonds(), bonds);
}
} // namespace
} // namespace pdx::test::strip_part
