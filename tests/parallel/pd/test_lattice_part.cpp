#include "pdx/base/gather.hpp"
#include "pdx/pd/bond_term.hpp"
#include "support/ranks.hpp"

#include <gtest/gtest.h>
#include <map>

namespace pdx::test::lattice_part {
namespace {
constexpr Index kWide = 19, kHigh = 17;

geom::Lattice<2> lattice() { return {{1.0, 2.0}, 0.25, {kWide, kHigh}}; }

pd::StencilOptions stencil_options(double ratio)
{
  pd::StencilOptions options;
  options.dx = 0.25;
  options.horizon = ratio * options.dx;
  options.elastic = {3.0, 1.0 / 3.0, law::Plane::stress, 1.0};
  return options;
}

/// Owner of a site: stripes that no sensible partitioner would cut, with single sites of others strewn in.
int owner(Index site) { return site % 11 == 3 ? site / 11 % ranks() : (site % kWide / 3 + site / kWide / 5) % ranks(); }

/// A number for every site, and for each of two components.
double value(Index site, Index component) { return 100.0 + 3.0 * site + 0.5 * component + 0.01 * (site * site % 97); }

/// This rank's share of the lattice, with other rows before its particles.
struct Share {
  std::vector<Index> sites;
  field::Rows rows;
  std::unique_ptr<pd::LatticePart<2>> part;
  std::vector<double> u; ///< owned rows * 2

  explicit Share(double ratio = 4.0)
  {
    for (Index site = 0; site < kWide * kHigh; ++site)
      if (owner(site) == rank()) sites.push_back(site);
    const Index nodes = 2 + rank();
    rows = field::Rows::number(PETSC_COMM_WORLD, 2, nodes, 0, static_cast<Index>(sites.size()));
    part = std::make_unique<pd::LatticePart<2>>(rows, lattice(), pd::make_stencil<2>(stencil_options(ratio)), sites,
                                                nodes, pd::SurfaceCorrection<2>());
    u.assign(static_cast<std::size_t>(2 * nodes), -1e6);
    for (const Index site : sites)
      for (Index a = 0; a < 2; ++a) u.push_back(value(site, a));
  }
};
} // namespace

TEST(LatticePart, HaloBringsTheValuesOfOtherRanks)
{
  const Share share;
  auto window = share.part->window();
  share.part->load(share.u, window);
  Index bonds = 0;
  for (Index k = 0; k < static_cast<Index>(share.sites.size()); ++k)
    share.part->for_each_bond(k, [&](std::size_t h, int sign, const Site<2>& other, double weight) {
      const auto j = static_cast<Index>(lattice().number(other)), i = share.sites[static_cast<std::size_t>(k)];
      const Vector<2> eta = share.part->relative(window, k, h, sign);
      for (Index a = 0; a < 2; ++a) EXPECT_EQ(eta[a], value(j, a) - value(i, a)) << i << " to " << j;
      EXPECT_EQ(weight, 1.0);
      ++bonds;
    });
  // Every pair within 4 spacings (but not at 4) counts twice: 48 - 4 = 44 neighbours inside, fewer near the border.
  Index expected = 0;
  for (Index i = 0; i < kWide * kHigh; ++i)
    for (Index j = 0; j < kWide * kHigh; ++j) {
      const Index x = i % kWide - j % kWide, y = i / kWide - j / kWide;
      expected += i != j && x * x + y * y < 16;
    }
  MPI_Allreduce(MPI_IN_PLACE, &bonds, 1, MPI_INT, MPI_SUM, PETSC_COMM_WORLD);
  EXPECT_EQ(bonds, expected);
}

TEST(LatticePart, LoadingAgainReplacesOldValues)
{
  Share share;
  auto window = share.part->window();
  share.part->load(share.u, window);
  for (double& u : share.u) u *= 2.0;
  share.part->load(share.u, window);
  for (Index k = 0; k < static_cast<Index>(share.sites.size()); ++k)
    share.part->for_each_bond(k, [&](std::size_t h, int sign, const Site<2>& other, double) {
      const auto j = static_cast<Index>(lattice().number(other)), i = share.sites[static_cast<std::size_t>(k)];
      EXPECT_EQ(share.part->relative(window, k, h, sign)[0], 2.0 * value(j, 0) - 2.0 * value(i, 0));
    });
}

TEST(LatticePart, RowsOfOwnedSitesOnlyUntilTheHaloIsNumbered)
{
  const Share share;
  for (Index site = 0; site < kWide * kHigh; ++site) {
    const Index row = share.part->row(lattice().site(site));
    if (owner(site) != rank())
      EXPECT_EQ(row, -1);
    else
      EXPECT_EQ(share.sites[static_cast<std::size_t>(row - share.rows.first_particle())], site);
  }
  field::RowHalo halo(share.rows, {share.part->halo_rows().begin(), share.part->halo_rows().end()});
  share.part->number_halo(halo);
  std::vector<Index> all(static_cast<std::size_t>(kWide * kHigh));
  for (Index site = 0; site < kWide * kHigh; ++site) all[static_cast<std::size_t>(site)] = site;
  const std::vector<PetscInt> global = share.part->directory().rows(all);
  Index bonds = 0;
  for (Index k = 0; k < static_cast<Index>(share.sites.size()); ++k)
    share.part->for_each_bond(k, [&](std::size_t, int, const Site<2>& other, double) {
      ++bonds;
      EXPECT_EQ(halo.global(share.part->row(other)), global[static_cast<std::size_t>(lattice().number(other))]);
    });
  EXPECT_EQ(bonds > 0, !share.sites.empty());
}

// Forces of the bond kernels on windows with holes against a double loop over all pairs.
TEST(LatticePart, ForcesMatchADoubleLoopOverAllPairs)
{
  const Share share;
  const pd::Stencil<2> stencil = share.part->stencil();
  std::map<std::pair<Index, Index>, double> stiffness; // by step; both halves
  for (const auto& arm : stencil.half)
    for (const Index sign : {1, -1})
      stiffness[{sign * arm.step[0], sign * arm.step[1]}] = arm.kappa / std::pow(arm.length, 3);
  auto window = share.part->window();
  share.part->load(share.u, window);
  std::vector<double> force(share.u.size(), 0.0);
  pd::add_force<2>(share.part->view(window), share.part->force_runs(), law::Kinematics::small, force.data());
  const geom::Lattice<2> grid = lattice();
  for (std::size_t k = 0; k < share.sites.size(); ++k) {
    const Index i = share.sites[k];
    Vector<2> expected = Vector<2>::Zero();
    for (Index j = 0; j < kWide * kHigh; ++j) {
      const auto s = stiffness.find({j % kWide - i % kWide, j / kWide - i / kWide});
      if (s == stiffness.end()) continue;
      const Vector<2> xi = grid.point(grid.site(j)) - grid.point(grid.site(i));
      const Vector<2> eta(value(j, 0) - value(i, 0), value(j, 1) - value(i, 1));
      expected -= s->second * xi.dot(eta) * xi;
    }
    const auto row = 2 * (static_cast<std::size_t>(share.rows.first_particle()) + k);
    EXPECT_NEAR(force[row], expected.x(), 1e-10 * 300.0);
    EXPECT_NEAR(force[row + 1], expected.y(), 1e-10 * 300.0);
  }
}

TEST(SiteDirectory, KnowsEverySiteFromEveryRank)
{
  // Every fifth site belongs to no one; rows start at 1000 + 100 rank.
  std::vector<Index> mine;
  for (Index site = 0; site < kWide * kHigh; ++site)
    if (site % 5 && owner(site) == rank()) mine.push_back(site);
  const pd::SiteDirectory directory(PETSC_COMM_WORLD, kWide * kHigh, mine, 1000 * (rank() + 1));
  std::vector<Index> asked;
  for (Index k = 0; k < 3 * kWide * kHigh / (rank() + 1); ++k) asked.push_back(k * 7 % (kWide * kHigh)); // repeats too
  const std::vector<PetscInt> rows = directory.rows(asked);
  ASSERT_EQ(rows.size(), asked.size());
  for (std::size_t k = 0; k < asked.size(); ++k) {
    PetscInt expected = -1;
    if (asked[k] % 5) {
      expected = 1000 * (owner(asked[k]) + 1);
      for (Index site = 0; site < asked[k]; ++site) expected += site % 5 && owner(site) == owner(asked[k]);
    }
    EXPECT_EQ(rows[k], expected) << "site " << asked[k];
  }
  EXPECT_TRUE(directory.rows({}).empty());
}

// Family of a conical horizon of 2 dx: 4 at 1 and 4 at sqrt 2 in full, 4 at 2 by half: 10 dx^2.
TEST(FamilyShare, OfEdgeAndCornerParticlesByHand)
{
  pd::StencilOptions options = stencil_options(2.0);
  options.calibration = pd::Calibration::continuum;
  const auto stencil = pd::make_stencil<2>(options);
  EXPECT_NEAR(stencil.family_volume_full(), 10.0 * 0.25 * 0.25, 1e-15);
  const geom::Lattice<2> grid = lattice();
  const pd::Exists<2> exists = [&](const Site<2>& site) { return grid.contains(site); };
  EXPECT_EQ(pd::family_reach<2>(stencil), 2);
  EXPECT_NEAR(pd::family_share<2>(stencil, {5, 5}, exists), 1.0, 1e-15);
  EXPECT_NEAR(pd::family_share<2>(stencil, {5, 0}, exists), 0.65, 1e-15);        // misses 3 + 1/2
  EXPECT_NEAR(pd::family_share<2>(stencil, {5, 1}, exists), 0.95, 1e-15);        // misses 1/2
  EXPECT_NEAR(pd::family_share<2>(stencil, {0, 0}, exists), 0.4, 1e-15);         // misses 5 + 2/2
  EXPECT_NEAR(pd::family_share<2>(stencil, {kWide - 1, 1}, exists), 0.6, 1e-15); // misses 3 + 2/2
}

TEST(FamilyShare, WeighsTheBondsOfAnIrregularPartition)
{
  pd::StencilOptions options = stencil_options(2.0);
  options.calibration = pd::Calibration::continuum;
  const Share share;
  const geom::Lattice<2> grid = lattice();
  const pd::Exists<2> exists = [&](const Site<2>& site) { return grid.contains(site); };
  const pd::LatticePart<2> part(share.rows, grid, pd::make_stencil<2>(options), share.sites,
                                share.rows.first_particle(),
                                pd::correct_volumes<2>(pd::make_stencil<2>(options), exists));
  const auto q = [](const Site<2>& s) {
    const bool edge_x = s[0] == 0 || s[0] == kWide - 1, edge_y = s[1] == 0 || s[1] == kHigh - 1;
    const bool next_x = s[0] == 1 || s[0] == kWide - 2, next_y = s[1] == 1 || s[1] == kHigh - 2;
    if (edge_x && edge_y) return 0.4;
    if ((edge_x && next_y) || (edge_y && next_x)) return 0.6;
    if (edge_x || edge_y) return 0.65;
    if (next_x && next_y) return 0.9;
    return next_x || next_y ? 0.95 : 1.0;
  };
  for (Index k = 0; k < static_cast<Index>(share.sites.size()); ++k)
    part.for_each_bond(k, [&](std::size_t, int, const Site<2>& other, double weight) {
      EXPECT_NEAR(weight, 2.0 / (q(grid.site(share.sites[static_cast<std::size_t>(k)])) + q(other)), 1e-14);
    });
}
} // namespace pdx::test::lattice_part
