#include "support/cracked.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace pdx::test {
namespace {
constexpr double kStiffness = 3.0 * 0.5; // E t: the force of a strain of 1 over the unit square [N]
constexpr couple::Scheme kSchemes[] = {couple::Scheme::energy, couple::Scheme::ghost, couple::Scheme::interface};

/// A line through the plate of 10 x 10 elements of 0.1 m; the patch, where there is one, is [0.3, 0.7]^2.
struct Line {
  const char* name;
  Vector<2> point;
  Vector<2> along;

  crack::Polyline points() const { return {point - 3.0 * along, point + 3.0 * along}; }
};

options::SceneOptions plate(const Line& line)
{
  options::SceneOptions options = held_plate({10, 10});
  options.cracks.lines = {line.points()};
  return options;
}

options::SceneOptions plate_with_patch(const Line& line, couple::Scheme scheme, double dx)
{
  options::SceneOptions options = plate(line);
  options.scheme = scheme;
  return with_patch(options, {{0.3, 0.3}, {0.7, 0.7}}, dx);
}

SidedField two_motions() { return {rigid(0.3, -0.2, 0.5), rigid(-0.1, 0.4, -0.7)}; }

/// Largest force under the two motions [N], and where.
std::pair<double, std::string> largest_force(Scene& scene)
{
  const std::vector<double> force = scene.internal_force(sided_blocks(scene, two_motions()));
  double most = 0.0;
  std::string where;
  for (std::size_t k = 0; k < force.size(); ++k)
    if (std::abs(force[k]) > most) {
      most = std::abs(force[k]);
      const Vector<2> x = scene.place(static_cast<Index>(k / 2));
      where = fmt::format("row {} of {} nodes, {} sets at ({}, {})", k / 2, scene.rows().nodes, scene.rows().enriched,
                          x.x(), x.y());
    }
  return {scene.max(most), where};
}

void expect_no_force(Scene& scene)
{
  const auto [force, where] = largest_force(scene);
  EXPECT_LT(force, 1e-10 * kStiffness) << where;
}

/// The sides of the plate are moved; all else must follow, in few iterations.
void expect_rigid_solution(Scene& scene)
{
  prescribe_sided(scene, two_motions());
  const VecHandle u = scene.solve();
  EXPECT_LE(scene.report().linear_iterations, 60);
  EXPECT_LT(sided_error(scene, u.get(), two_motions()), 1e-7);
}

const Line kInElements[] = {
    {"along an edge", {0.5, 0.5}, {1.0, 0.0}},
    {"along an edge, the other way", {0.5, 0.5}, {-1.0, 0.0}},
    {"up along an edge", {0.5, 0.5}, {0.0, 1.0}},
    {"just above an edge", {0.5, 0.5 + 1e-9}, {1.0, 0.0}},
    {"just below an edge", {0.5, 0.5 - 1e-9}, {1.0, 0.0}},
    {"through nodes, along the diagonals", {0.5, 0.5}, {1.0, 1.0}},
    {"through a node", {0.5, 0.5}, {0.9, 0.37}},
    {"steeply through a node", {0.5, 0.5}, {0.1, 0.97}},
    {"grazing a corner", {0.5 + 1e-7, 0.5 - 1e-7}, {1.0, -0.9}},
    {"grazing a corner within the tolerance", {0.5, 0.5 + 1e-13}, {0.8, 0.7}},
    {"grazing many corners", {0.5, 0.5 + 1e-5}, {1.0, 1.0}},
    {"a hair off an edge, at a slant", {0.5, 0.5}, {1.0, 1e-6}},
};

// The patch's corners are (0.3, 0.3), (0.7, 0.3), (0.7, 0.7) and (0.3, 0.7).
const Line kAtAPatch[] = {
    {"through a corner, outside else", {0.7, 0.7}, {1.0, -1.0}},
    {"through a corner, steeply outside", {0.3, 0.7}, {1.0, 3.1}},
    {"through a corner and the patch", {0.3, 0.3}, {1.0, 0.83}},
    {"through a corner and the patch, flat", {0.3, 0.3}, {1.0, 0.07}},
    {"through two corners", {0.5, 0.5}, {1.0, 1.0}},
    {"through two corners, falling", {0.5, 0.5}, {-1.0, 1.0}},
    {"grazing a corner from outside", {0.7 + 1e-7, 0.7}, {1.0, -1.1}},
    {"grazing a corner from inside", {0.7 - 1e-7, 0.7}, {1.0, -1.1}},
    {"cutting one particle off a corner", {0.68, 0.68}, {1.0, -1.0}},
    {"cutting three bonds off a corner", {0.695, 0.7}, {1.0, -0.8}},
    {"along the upper border", {0.5, 0.7}, {1.0, 0.0}},
    {"along the upper border, the other way", {0.5, 0.7}, {-1.0, 0.0}},
    {"along the lower border", {0.5, 0.3}, {1.0, 0.0}},
    {"along the lower border, the other way", {0.5, 0.3}, {-1.0, 0.0}},
    {"down along the right border", {0.7, 0.5}, {0.0, -1.0}},
    {"up along the left border", {0.3, 0.5}, {0.0, 1.0}},
    {"just inside the upper border", {0.5, 0.7 - 1e-9}, {1.0, 0.0}},
    {"just outside the upper border", {0.5, 0.7 + 1e-9}, {1.0, 0.0}},
    {"along an edge into the patch", {0.5, 0.5}, {1.0, 0.0}},
    {"along an edge into the patch, the other way", {0.5, 0.5}, {0.0, -1.0}},
    {"entering at a node", {0.3, 0.4}, {1.0, 0.45}},
    {"entering flat through the border", {0.3, 0.7}, {1.0, -0.05}},
};
} // namespace

TEST(AwkwardCracks, HalvesMoveRigidlyInElements)
{
  for (const Line& line : kInElements) {
    SCOPED_TRACE(line.name);
    Scene scene(plate(line), true);
    expect_no_force(scene);
    expect_rigid_solution(scene);
  }
}

TEST(AwkwardCracks, HalvesMoveRigidlyWithoutForceAtAPatch)
{
  for (const couple::Scheme scheme : kSchemes)
    for (const double dx : {0.05, 0.02})
      for (const auto& lines : {std::span<const Line>(kAtAPatch), std::span<const Line>(kInElements)})
        for (const Line& line : lines) {
          SCOPED_TRACE(fmt::format("{}, dx {}, scheme {}", line.name, dx, static_cast<int>(scheme)));
          Scene scene(plate_with_patch(line, scheme, dx));
          expect_no_force(scene);
        }
}

TEST(AwkwardCracks, SolvesToRigidHalvesAtAPatch)
{
  for (const couple::Scheme scheme : kSchemes)
    for (const Line& line : kAtAPatch) {
      SCOPED_TRACE(fmt::format("{}, scheme {}", line.name, static_cast<int>(scheme)));
      Scene scene(plate_with_patch(line, scheme, 0.05));
      expect_rigid_solution(scene);
    }
}
} // namespace pdx::test
