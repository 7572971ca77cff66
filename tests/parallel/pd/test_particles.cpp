#include "pdx/base/gather.hpp"
#include "pdx/mesh/locate.hpp"
#include "support/scene.hpp"

#include <gtest/gtest.h>
#include <tuple>

using namespace pdx;

namespace {
constexpr auto kNumber = [](const pd::Particle& p) { return std::tuple(p.patch, p.site); };

options::SceneOptions two_patches()
{
  const auto one =
      test::with_patch(test::held_plate({10, 8}, {{0.0, 0.0}, {1.0, 0.8}}), {{0.2, 0.2}, {0.4, 0.6}}, 0.05);
  return test::with_patch(one, {{0.6, 0.1}, {0.9, 0.5}}, 0.025);
}

struct OwnedCell {
  std::array<double, 2> lower, upper; // [m]
  int owner;
};

/// Owner of the cell that holds x, from a list of all cells.
int owner_at(const std::vector<OwnedCell>& cells, const Vector<2>& x)
{
  for (const OwnedCell& cell : cells)
    if (x[0] > cell.lower[0] && x[1] > cell.lower[1] && x[0] < cell.upper[0] && x[1] < cell.upper[1]) return cell.owner;
  return -1;
}

Index cell_at(const mesh::Mesh& mesh, const Vector<2>& x)
{
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    std::array<Index, 4> natural{};
    for (std::size_t a = 0; a < 4; ++a) natural[a] = mesh.natural_vertex(mesh.cell(c)[a]);
    if (mesh::cell_holds(mesh.corners(c), natural, x, 1e-9)) return c;
  }
  return -1;
}
} // namespace

TEST(Particles, ScatteredOnesMigrateToTheRankOfTheirCell)
{
  test::Scene scene(two_patches());
  int rank = 0, ranks = 1;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  std::vector<OwnedCell> cells;
  for (Index c = 0; c < scene.mesh().owned_cells(); ++c) {
    const auto corners = scene.mesh().corners(c);
    cells.push_back({{corners[0][0], corners[0][1]}, {corners[2][0], corners[2][1]}, rank});
  }
  cells = gather_all(PETSC_COMM_WORLD, cells);

  // Dealt out one by one, from the last to the first.
  std::vector<pd::Particle> dealt;
  for (Index p = 1; p >= 0; --p) {
    const auto& lattice = scene.plan().shapes[static_cast<std::size_t>(p)].lattice;
    for (auto site = static_cast<Index>(lattice.total()) - 1; site >= 0; --site)
      if (site % ranks == rank) dealt.push_back({p, site, -1, lattice.point(lattice.site(site))});
  }
  pd::Particles swarm(PETSC_COMM_WORLD);
  swarm.add(dealt);
  std::vector<int> owner;
  for (const pd::Particle& p : dealt) owner.push_back(owner_at(cells, p.x));
  swarm.migrate(owner);

  const std::vector<pd::Particle> found = swarm.sorted();
  const std::vector<pd::Particle>& expected = scene.d().particles;
  EXPECT_EQ(scene.sum(static_cast<double>(found.size())), 4 * 8 + 12 * 16); // none lost
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(kNumber(found[k]), kNumber(expected[k]));
    EXPECT_EQ(found[k].x, expected[k].x);
    EXPECT_EQ(cell_at(scene.mesh(), found[k].x), expected[k].cell);
    EXPECT_EQ(found[k].cell, -1); // to be located again
    if (k) {
      EXPECT_LT(kNumber(found[k - 1]), kNumber(found[k]));
    }
  }
}

TEST(Particles, ComeInSeveralBatches)
{
  pd::Particles swarm(PETSC_COMM_WORLD);
  EXPECT_EQ(swarm.local_size(), 0);
  EXPECT_TRUE(swarm.sorted().empty());
  const std::vector<pd::Particle> first = {{0, 7, 1, {0.7, 0.0}}, {0, 2, 1, {0.2, 0.0}}},
                                  second = {{0, 5, 1, {0.5, 0.0}}};
  swarm.add(first);
  swarm.add({});
  swarm.add(second);
  const std::vector<pd::Particle> all = swarm.sorted();
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].site, 2);
  EXPECT_EQ(all[1].site, 5);
  EXPECT_EQ(all[2].site, 7);
  EXPECT_EQ(all[1].x.x(), 0.5);
}

// 1/2 sigma e of the plane-stress solid at every particle: inside, beside the interface and at the corners.
TEST(EnergyDensity, OfAUniformStrainIsThatOfTheContinuum)
{
  const auto field = test::affine(2e-3, 1e-3, 5e-4, -1e-3); // e_xx, e_yy = 2e-3, -1e-3, gamma = 1.5e-3
  const Eigen::Vector3d strain(2e-3, -1e-3, 1.5e-3);
  const double expected = 0.5 * strain.dot(test::plane_stress().stiffness() * strain);
  for (const auto scheme : {couple::Scheme::energy, couple::Scheme::ghost, couple::Scheme::interface}) {
    auto options = two_patches();
    options.scheme = scheme;
    test::Scene scene(options);
    const auto u = scene.blocks(field);
    std::vector<double> density = scene.d().bonds->energy_density(u);
    scene.d().carried->add_energy_density(u, density);
    const auto& particles = scene.d().particles;
    for (std::size_t k = 0; k < particles.size(); ++k)
      EXPECT_NEAR(density[static_cast<std::size_t>(scene.rows().first_particle()) + k], expected, 1e-10 * expected)
          << "at " << particles[k].x.transpose();
  }
}

// In the energy scheme bonds and elements together hold exactly the energy of the uniformly strained solid.
TEST(EnergyDensity, EnergySchemeHoldsTheEnergyOfTheWholeSolid)
{
  const test::Scene scene(two_patches());
  const Eigen::Vector3d strain(2e-3, -1e-3, 1.5e-3);
  const double expected = 0.5 * strain.dot(test::plane_stress().stiffness() * strain) * 0.8 * 0.5; // area * thickness
  EXPECT_NEAR(scene.energy(scene.blocks(test::affine(2e-3, 1e-3, 5e-4, -1e-3))), expected, 1e-12 * expected);
}
