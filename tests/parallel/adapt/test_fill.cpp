#include "pdx/adapt/fill.hpp"

#include "support/scene.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/scene/scene_names.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <set>

using namespace pdx;
using test::Field;

namespace {
constexpr Index kCells = 12; // of the unit square, per side
constexpr double kElement = 1.0 / kCells;

geom::Box<2> box(Index x0, Index y0, Index x1, Index y1) ///< in elements
{
  return {kElement * Vector<2>(x0, y0), kElement * Vector<2>(x1, y1)};
}

options::SceneOptions plate(const std::vector<geom::Box<2>>& patches, double ratio = 4.0)
{
  options::SceneOptions options = test::held_plate({kCells, kCells});
  for (const geom::Box<2>& patch : patches) options = test::with_patch(std::move(options), patch, kElement / ratio);
  return options;
}

Field quadratic()
{
  return [](const Vector<2>& x) -> Vector<2> {
    return {0.3 + x[0] - 2.0 * x[1] + 3.0 * x[0] * x[0] - x[0] * x[1], x[1] + 0.5 * x[1] * x[1] - 2.0 * x[0] * x[1]};
  };
}

/// Names of all particles, of all ranks.
std::set<std::uint64_t> names_of(const test::Scene& scene, scene::Discretisation& d)
{
  const scene::Standing standing{const_cast<mesh::Mesh*>(&scene.mesh()), &d};
  const scene::SceneNames names(standing);
  std::vector<std::uint64_t> mine;
  for (const field::RowName name : names.particles()) mine.push_back(name.value());
  const std::vector<std::uint64_t> all = gather_all(scene.mesh().comm(), mine);
  return {all.begin(), all.end()};
}

Vector<2> place_of(const test::Scene& scene, field::RowName name)
{
  const couple::PatchShape& shape = scene.plan().shapes[0];
  return shape.lattice.point(shape.names.site(name.key()).value());
}

/// The largest error of the particles that `covers` make, over the largest value; and each is where its name says.
double fill_error(test::Scene& scene, const std::vector<geom::Box<2>>& boxes, const Field& field)
{
  std::vector<adapt::LayoutChange::Cover> covers;
  for (const geom::Box<2>& b : boxes) covers.push_back({b, scene.plan().shapes[0].lattice.dx});
  const std::vector<double> u = scene.blocks(field);
  std::vector<double> twice(u);
  for (double& value : twice) value *= 2.0;
  const std::span<const double> fields[] = {u, twice};
  const adapt::FreshRows fresh =
      adapt::fill_particles(scene.d().view(scene.mesh()), covers, scene.plan().shapes, fields);

  std::vector<geom::Box<2>> all = scene.options().pd.patches;
  all.insert(all.end(), boxes.begin(), boxes.end());
  options::SceneOptions options = plate(all, kElement / scene.plan().shapes[0].lattice.dx);
  options.cracks = scene.options().cracks;
  test::Scene later(options);
  const std::set<std::uint64_t> known = names_of(later, later.d());
  double worst = 0.0, largest = 0.0;
  for (std::size_t k = 0; k < fresh.names.size(); ++k) {
    EXPECT_TRUE(known.contains(fresh.names[k].value()));
    const Vector<2> exact = field(place_of(scene, fresh.names[k]));
    for (std::size_t f = 0; f < 2; ++f) {
      const Vector<2> found(fresh.fields[f][2 * k], fresh.fields[f][2 * k + 1]);
      worst = std::max(worst, (found - (f ? 2.0 : 1.0) * exact).norm());
    }
    largest = std::max(largest, exact.norm());
  }
  const double wanted = std::pow(scene.plan().shapes[0].lattice.dx, -2),
               count = scene.sum(static_cast<double>(fresh.names.size()));
  double area = 0.0;
  for (const geom::Box<2>& b : boxes) area += b.size().prod();
  EXPECT_NEAR(count, area * wanted, 1e-6 * count);
  return scene.max(worst) / scene.max(largest);
}
} // namespace

TEST(Fill, QuadraticsAreExactInside)
{
  test::Scene scene(plate({box(4, 4, 8, 8)}));
  EXPECT_LT(fill_error(scene, {box(8, 5, 10, 8), box(5, 8, 6, 9)}, quadratic()), 1e-11);
}

TEST(Fill, AffineFieldsAreExactAtTheEdgeOfTheBody)
{
  test::Scene scene(plate({box(4, 4, 8, 8)}));
  EXPECT_LT(fill_error(scene, {box(8, 5, 12, 8), box(5, 8, 6, 12)}, test::affine(0.1, -0.2, 0.3, 0.4, {1.0, 2.0})),
            1e-12);
}

TEST(Fill, ErrorsFallWithTheCubeOfElements)
{
  const Field wave = [](const Vector<2>& x) -> Vector<2> {
    return {std::sin(2.0 * x[0] + x[1]), std::cos(x[0] - 3.0 * x[1])};
  };
  const auto error = [&wave](Index finer) {
    options::SceneOptions options = test::held_plate({finer * kCells, finer * kCells});
    options = test::with_patch(std::move(options), box(4, 4, 8, 8), kElement / (4.0 * finer));
    test::Scene scene(options);
    const std::vector<double> u = scene.blocks(wave);
    const std::span<const double> fields[] = {u};
    const std::vector<adapt::LayoutChange::Cover> covers{{box(8, 5, 10, 8), scene.plan().shapes[0].lattice.dx}};
    const adapt::FreshRows fresh =
        adapt::fill_particles(scene.d().view(scene.mesh()), covers, scene.plan().shapes, fields);
    double worst = 0.0;
    for (std::size_t k = 0; k < fresh.names.size(); ++k) {
      const Vector<2> x = place_of(scene, fresh.names[k]);
      worst = std::max(worst, (Vector<2>(fresh.fields[0][2 * k], fresh.fields[0][2 * k + 1]) - wave(x)).norm());
    }
    return scene.max(worst);
  };
  const double coarse = error(1), fine = error(2);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_GT(std::log2(coarse / fine), 2.7);
}

TEST(Fill, SidesOfACrackMoveApart)
{
  options::SceneOptions options = plate({box(4, 4, 8, 8)});
  options.cracks.lines = {{{0.0, 6.5 * kElement}, {6.0 * kElement, 6.5 * kElement}}};
  test::Scene scene(options);
  const double line = 6.5 * kElement;
  const Field parted = [line](const Vector<2>& x) -> Vector<2> {
    return x[1] >= line ? Vector<2>(0.1 * x[0] + 1.0, 0.2 * x[1]) : Vector<2>(-0.1 * x[1], 0.3 * x[0]);
  };
  std::vector<double> u = scene.blocks(parted);
  // An enriched set holds half the opening there.
  const scene::Discretisation& d = scene.d();
  std::vector<double> owned(u.begin(), u.begin() + 2 * scene.rows().owned());
  std::size_t row = static_cast<std::size_t>(scene.rows().nodes);
  for (const Index v : d.sets->vertices()) {
    const Vector<2> x = scene.mesh().point(v);
    const Vector<2> above(0.1 * x[0] + 1.0, 0.2 * x[1]), below(-0.1 * x[1], 0.3 * x[0]);
    const Vector<2> half = 0.5 * (above - below);
    owned[2 * row] = half[0];
    owned[2 * row + 1] = half[1];
    ++row;
  }
  scene.system().halo->fetch(owned, 2, u);
  const std::span<const double> fields[] = {u};
  const std::vector<adapt::LayoutChange::Cover> covers{{box(2, 5, 4, 8), scene.plan().shapes[0].lattice.dx}};
  const adapt::FreshRows fresh = adapt::fill_particles(d.view(scene.mesh()), covers, scene.plan().shapes, fields);
  double worst = 0.0;
  for (std::size_t k = 0; k < fresh.names.size(); ++k) {
    const Vector<2> x = place_of(scene, fresh.names[k]);
    worst = std::max(worst, (Vector<2>(fresh.fields[0][2 * k], fresh.fields[0][2 * k + 1]) - parted(x)).norm());
  }
  EXPECT_LT(scene.max(worst), 1e-12);
  EXPECT_EQ(scene.sum(static_cast<double>(fresh.names.size())), 2.0 * 3.0 * 16.0);
}

TEST(Fill, NodesTakeQuadraticsFromParticles)
{
  test::Scene scene(plate({box(3, 3, 9, 9)}));
  const std::vector<double> u = scene.blocks(quadratic());
  const std::span<const double> fields[] = {u};
  adapt::LayoutChange change;
  change.uncover = {box(3, 3, 5, 5), box(5, 3, 6, 4)};
  const adapt::FreshRows fresh = adapt::fill_nodes(scene.d().view(scene.mesh()), change, fields);
  double worst = 0.0;
  for (std::size_t k = 0; k < fresh.names.size(); ++k) {
    ASSERT_EQ(fresh.names[k].kind(), field::RowName::Kind::node);
    const auto number = static_cast<Index>(fresh.names[k].key());
    for (Index v = 0; v < scene.mesh().owned_vertices(); ++v)
      if (scene.mesh().natural_vertex(v) == number)
        worst = std::max(
            worst, (Vector<2>(fresh.fields[0][2 * k], fresh.fields[0][2 * k + 1]) - quadratic()(scene.mesh().point(v)))
                       .norm());
  }
  EXPECT_LT(scene.max(worst), 1e-10);
  EXPECT_EQ(scene.sum(static_cast<double>(fresh.names.size())), 5.0); // those on the border have rows already
}
