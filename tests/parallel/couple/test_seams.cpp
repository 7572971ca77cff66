#include "support/scene.hpp"
#include "support/scratch_directory.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <map>

using namespace pdx;
using couple::Scheme;

namespace {
/// Which part of the mesh a cell belongs to, by its centre; nodes are doubled where parts meet, and triple at corners.
using PartOf = std::function<int(const Vector<2>& x)>;

/// The unit square in n x n cells. Nodes on `glued` are not doubled.
void write_parts(const std::string& path, Index n, const PartOf& part,
                 const std::function<bool(const Vector<2>&)>& glued)
{
  std::map<std::tuple<Index, Index, int>, int> nodes;
  std::string points, cells;
  const auto node = [&](Index i, Index j, int of) {
    const Vector<2> x(double(i) / n, double(j) / n);
    const auto [at, fresh] = nodes.try_emplace({i, j, glued(x) ? 0 : of}, static_cast<int>(nodes.size()) + 1);
    if (fresh) points += std::to_string(at->second) + " " + std::to_string(x[0]) + " " + std::to_string(x[1]) + " 0\n";
    return std::to_string(at->second);
  };
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const int of = part(Vector<2>((i + 0.5) / n, (j + 0.5) / n));
      cells += std::to_string(j * n + i + 1) + " 3 2 1 1 " + node(i, j, of) + " " + node(i + 1, j, of) + " " +
               node(i + 1, j + 1, of) + " " + node(i, j + 1, of) + "\n";
    }
  std::ofstream(path) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n"
                      << nodes.size() << "\n"
                      << points << "$EndNodes\n$Elements\n"
                      << n * n << "\n"
                      << cells << "$EndElements\n";
}

class Parted {
public:
  Parted(Index n, const PartOf& part, const std::function<bool(const Vector<2>&)>& glued) : scratch_(PETSC_COMM_WORLD)
  {
    options.mesh.file = (scratch_.path() / "parts.msh").string();
    int rank = 0;
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    if (rank == 0) write_parts(options.mesh.file, n, part, glued);
    MPI_Barrier(PETSC_COMM_WORLD);
    options.elastic = test::plane_stress();
    options::BoundaryCondition held;
    held.name = "held";
    held.on = "unnamed";
    held.displacement = {0.0, 0.0};
    options.conditions.push_back(held);
  }
  options::SceneOptions options;

private:
  test::ScratchDirectory scratch_;
};

/// Each row with the field of its part.
std::vector<double> blocks(test::Scene& scene, const PartOf& part, const std::vector<test::Field>& fields)
{
  std::map<Index, Vector<2>> seen_from; // a point of a cell of each vertex
  for (Index c = 0; c < scene.mesh().cells(); ++c)
    for (const Index v : scene.mesh().cell(c)) seen_from[v] = scene.mesh().centroid(c);
  std::vector<double> owned, all;
  for (Index row = 0; row < scene.rows().owned(); ++row) {
    const Vector<2> x = scene.place(row);
    const bool node = row < scene.rows().nodes;
    const int of = part(node ? seen_from.at(scene.d().nodes[static_cast<std::size_t>(row)]) : x);
    const Vector<2> value = fields[static_cast<std::size_t>(of)](x);
    owned.insert(owned.end(), {value.x(), value.y()});
  }
  scene.system().halo->fetch(owned, 2, all);
  return all;
}

double largest_force(test::Scene& scene, std::span<const double> u)
{
  double most = 0.0;
  for (const double f : scene.internal_force(u)) most = std::max(most, std::abs(f));
  return scene.max(most);
}

bool nowhere(const Vector<2>&) { return false; }

/// An L of particles whose boxes meet on y = 0.5, with its corner at (0.5, 0.5).
options::SceneOptions with_l(const options::SceneOptions& options, double dx)
{
  return test::with_patch(test::with_patch(options, {{0.2, 0.2}, {0.8, 0.5}}, dx), {{0.2, 0.5}, {0.5, 0.8}}, dx);
}
} // namespace

TEST(Seams, PartsMoveRigidlyWithoutForce)
{
  // An L whose corner is in the patch, a T, and a cross: bonds through the joints are cut too.
  const std::vector<PartOf> layouts = {
      [](const Vector<2>& x) { return x[0] < 0.4 && x[1] > 0.4 ? 1 : 0; },
      [](const Vector<2>& x) { return x[1] > 0.5   ? 2
                                      : x[0] > 0.5 ? 1
                                                   : 0; },
      [](const Vector<2>& x) { return (x[1] > 0.4 ? 2 : 0) + (x[0] > 0.4 ? 1 : 0); },
      [](const Vector<2>& x) { return (x - Vector<2>(0.5, 0.5)).cwiseAbs().maxCoeff() < 0.2 ? 1 : 0; }}; // an island
  const std::vector<test::Field> fields = {
      test::affine(0.0, -0.5, 0.5, 0.0), test::affine(0.0, 0.3, -0.3, 0.0, {0.2, 0.1}),
      test::affine(0.0, 0.0, 0.0, 0.0, {-0.4, 0.7}), test::affine(0.0, 0.7, -0.7, 0.0)};
  for (const PartOf& part : layouts)
    for (const Scheme scheme : {Scheme::energy, Scheme::ghost, Scheme::interface})
      for (const double dx : {0.1, 0.05, 0.06}) { // 0.06: seams lie in lattice cells
        Parted scene(10, part, nowhere);
        scene.options.scheme = scheme;
        scene.options.conditions[0].box = geom::Box<2>{{-1.0, -1.0}, {2.0, 2.0}};
        scene.options.time.analysis = options::Analysis::implicit_dynamics; // an island needs no supports then
        test::Scene built(test::with_patch(scene.options, {{0.2, 0.2}, {0.8, 0.8}}, dx), true);
        EXPECT_LT(largest_force(built, blocks(built, part, fields)), 1e-12) << static_cast<int>(scheme) << ' ' << dx;
        EXPECT_GT(largest_force(built, built.blocks(test::affine(0.3, 0.0, 0.0, 0.0))), 1e-2);
      }
}

TEST(Seams, AlongAnLAndItsBordersPartsMoveRigidlyWithoutForce)
{
  // Along a joint of boxes and on along the border; blocks of elements behind a border, and around the corner.
  const std::vector<PartOf> layouts = {
      [](const Vector<2>& x) { return x[1] > 0.5 ? 1 : 0; }, [](const Vector<2>& x) { return x[0] > 0.5 ? 1 : 0; },
      [](const Vector<2>& x) { return (x - Vector<2>(0.65, 0.55)).cwiseAbs().maxCoeff() < 0.05 ? 1 : 0; },
      [](const Vector<2>& x) { return (x - Vector<2>(0.5, 0.5)).cwiseAbs().maxCoeff() < 0.1 ? 1 : 0; }};
  const std::vector<test::Field> fields = {test::affine(0.0, -0.5, 0.5, 0.0),
                                           test::affine(0.0, 0.3, -0.3, 0.0, {0.2, 0.1})};
  for (std::size_t k = 0; k < layouts.size(); ++k)
    for (const double dx : {0.1, 0.05}) {
      Parted scene(10, layouts[k], nowhere);
      scene.options.conditions[0].box = geom::Box<2>{{-1.0, -1.0}, {2.0, 2.0}};
      scene.options.time.analysis = options::Analysis::implicit_dynamics; // a block needs no supports then
      test::Scene built(with_l(scene.options, dx), true);
      EXPECT_LT(largest_force(built, blocks(built, layouts[k], fields)), 1e-12) << k << ' ' << dx;
    }
}

TEST(Seams, AlongTheJointOfAnLCutTheBondsThatACrackCuts)
{
  Parted seam(
      10, [](const Vector<2>& x) { return x[1] > 0.5 ? 1 : 0; },
      [](const Vector<2>& x) { return x[0] < 0.35 || x[0] > 0.65; });
  Parted whole(
      10, [](const Vector<2>&) { return 0; }, nowhere);
  whole.options.cracks.lines = {{{0.3, 0.5}, {0.7, 0.5}}};
  test::Scene with_seam(with_l(seam.options, 0.05), true), with_crack(with_l(whole.options, 0.05), true);
  const auto bonds = [](test::Scene& scene) { return scene.sum(static_cast<double>(scene.d().bonds->bonds())); };
  EXPECT_EQ(bonds(with_seam), bonds(with_crack));
}

TEST(Seams, CutTheBondsThatACrackCuts)
{
  const PartOf above = [](const Vector<2>& x) { return x[1] > 0.5 ? 1 : 0; };
  Parted seam(10, above, [](const Vector<2>& x) { return x[0] < 0.35 || x[0] > 0.65; });
  test::Scene with_seam(test::with_patch(seam.options, {{0.2, 0.2}, {0.8, 0.8}}, 0.05), true);
  Parted whole(
      10, [](const Vector<2>&) { return 0; }, nowhere);
  const std::int64_t all =
      test::Scene(test::with_patch(whole.options, {{0.2, 0.2}, {0.8, 0.8}}, 0.05), true).d().bonds->bonds();
  whole.options.cracks.lines = {{{0.3, 0.5}, {0.7, 0.5}}};
  test::Scene with_crack(test::with_patch(whole.options, {{0.2, 0.2}, {0.8, 0.8}}, 0.05), true);
  const auto lost = [&](test::Scene& scene) { return all - scene.d().bonds->bonds(); };
  EXPECT_EQ(with_seam.sum(static_cast<double>(lost(with_seam))), with_crack.sum(static_cast<double>(lost(with_crack))));
  EXPECT_GT(with_seam.sum(static_cast<double>(lost(with_seam))), 0.0);
}
