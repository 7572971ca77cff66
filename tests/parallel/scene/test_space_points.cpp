#include "pdx/adapt/space_conversion.hpp"
#include "pdx/scene/layout.hpp"
#include "pdx/scene/scene.hpp"
#include "pdx/scene/space_body.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>

namespace pdx::space_points_test {
constexpr Index kCells = 10; // of the unit cube, per side: coordinates are kept as decimals
constexpr double kCell = 1.0 / kCells;
constexpr double kSmall = 1e-12; // strain: what is not linear is as small

using SpaceField = std::function<Vector<3>(const Vector<3>& x)>;

SpaceField affine(const Tensor<3>& gradient)
{
  return [gradient](const Vector<3>& x) -> Vector<3> { return gradient * x; };
}

/// In [-1, 1), of the place alone.
Vector<3> noise(const Vector<3>& x)
{
  Vector<3> value;
  for (int d = 0; d < 3; ++d) value[d] = std::sin(1e4 * (x[0] + 1.7 * x[1] + 2.9 * x[2]) + d);
  return value;
}

geom::Box<3> cells(const Site<3>& lower, const Site<3>& upper)
{
  return {kCell * Vector<3>(lower[0], lower[1], lower[2]), kCell * Vector<3>(upper[0], upper[1], upper[2])};
}

/// Cells that have no pattern, off the border.
std::vector<geom::Box<3>> scattered()
{
  std::vector<geom::Box<3>> boxes;
  for (Site<3> at{2, 2, 2}; at[2] < kCells - 2; ++at[2])
    for (at[1] = 2; at[1] < kCells - 2; ++at[1])
      for (at[0] = 2; at[0] < kCells - 2; ++at[0])
        if (noise(Vector<3>(at[0], at[1], at[2]))[0] > 0.4)
          boxes.push_back(cells(at, {at[0] + 1, at[1] + 1, at[2] + 1}));
  return boxes;
}

/// Material points in the unit cube, and what of it are particles.
options::SceneOptions cube_of_points(const std::vector<geom::Box<3>>& boxes)
{
  options::SceneOptions options;
  options.solid = true;
  options.elastic = {3.0, 0.25, law::Plane::strain, 1.0, 1.0};
  options.kinematics = options::KinematicsOption::finite;
  options.time.analysis = options::Analysis::explicit_dynamics;
  options::PointBodyOptions body;
  body.name = "cube";
  body.shape.box = geom::Box<3>{Vector<3>::Zero(), Vector<3>::Ones()};
  body.elastic = options.elastic;
  body.spacing = 0.5 * kCell;
  options.points.bodies.push_back(body);
  options.pd.boxes = boxes;
  options.pd.to_come = true;
  options.pd.spacing = {body.spacing};
  options.pd.horizon_ratio = 3.015;
  return options;
}

bool inside(const Vector<3>& x) { return (x.array() > 1e-9).all() && (x.array() < 1.0 - 1e-9).all(); }
bool everywhere(const Vector<3>&) { return true; }

class SpaceCube {
public:
  explicit SpaceCube(const options::SceneOptions& given)
      : options_(given), make_(scene::scene_in_time(PETSC_COMM_WORLD, options_)),
        scene_(make_(scene::Layout::given(options_), nullptr))
  {}
  field::System& system() { return scene_->system(); }
  const adapt::SpaceView& view() { return *scene_->space(); }
  const law::Elastic& elastic() const { return options_.elastic; }
  Index rows() { return system().rows.owned(); }
  Vector<3> place(Index row)
  {
    return Eigen::Map<const Vector<3>>(&system().coordinates[static_cast<std::size_t>(3 * row)]);
  }
  double sum(double mine)
  {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
    return mine;
  }

  std::vector<double> blocks(const SpaceField& field)
  {
    std::vector<double> owned, all;
    for (Index row = 0; row < rows(); ++row) {
      const Vector<3> value = field(place(row));
      owned.insert(owned.end(), value.begin(), value.end());
    }
    system().halo->fetch(owned, 3, all);
    return all;
  }
  std::vector<double> force(const SpaceField& field)
  {
    std::vector<double> r(static_cast<std::size_t>(3 * rows()), 0.0);
    const std::vector<double> u = blocks(field);
    for (const auto& term : system().terms) term->add_residual(u, r);
    return r;
  }

  /// Largest force on a row that counts, over that on the side of a cell at the largest strain of the field.
  double unbalanced(const SpaceField& field, double strain,
                    const std::function<bool(const Vector<3>&)>& counts = inside)
  {
    const std::vector<double> r = force(field);
    double worst = 0.0;
    for (Index row = 0; row < rows(); ++row) {
      if (counts(place(row)))
        worst = std::max(worst, Eigen::Map<const Vector<3>>(&r[static_cast<std::size_t>(3 * row)]).norm());
    }
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
    return worst / (options_.elastic.young * strain * kCell * kCell);
  }

private:
  options::SceneOptions options_;
  scene::SceneMaker make_;
  std::unique_ptr<scene::Scene> scene_;
};

Tensor<3> gradient(std::initializer_list<double> rows)
{
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows.begin());
}
const std::vector<geom::Box<3>> kBlock{cells({4, 3, 3}, {8, 7, 6})},
    kCorner{cells({2, 2, 2}, {8, 4, 5}), cells({2, 2, 2}, {4, 7, 5}), cells({3, 3, 5}, {4, 4, 8})},
    kSlab{cells({4, 0, 0}, {7, kCells, kCells})};

const Tensor<3> kStrains[] = {
    gradient({1, 0, 0, 0, 0, 0, 0, 0, 0}), gradient({-1, 0, 0, 0, 1, 0, 0, 0, 0.5}),
    gradient({0, 1, 0, 1, 0, 0, 0, 0, 0}), gradient({0, 0, 1, 0, 0, 0, 1, 0, 0}),
    gradient({0, 0, 0, 0, 0, 1, 0, 1, 0}), gradient({0.3, -0.2, 0.7, 0.1, -1, 0.4, 0, 0.9, 0.5})};

// mpm.md section 2, 7e-13 in the plane: a uniform strain leaves no force, whatever cells are particles.
TEST(SpacePoints, UniformStrainIsInBalance)
{
  for (const auto& boxes : {kBlock, kCorner, scattered()}) {
    SpaceCube cube(cube_of_points(boxes));
    ASSERT_GT(cube.sum(cube.system().rows.particles), 0.0);
    ASSERT_GT(cube.sum(cube.system().rows.nodes), 0.0);
    for (const Tensor<3>& strain : kStrains) EXPECT_LT(cube.unbalanced(affine(kSmall * strain), kSmall), 1e-12);
  }
}

TEST(SpacePoints, OtherBondsAreInBalanceToo)
{
  options::SceneOptions options = cube_of_points(kCorner);
  options.pd.micromodulus = law::Micromodulus::uniform;
  SpaceCube cube(options);
  for (const Tensor<3>& strain : kStrains) EXPECT_LT(cube.unbalanced(affine(kSmall * strain), kSmall), 1e-12);
}

/// Free to contract along z, which the body has sides across.
const Tensor<3> kFree[] = {gradient({1, 0, 0, 0, 0, 0, 0, 0, -1.0 / 3.0}),
                           gradient({0, 0, 0, 0, 1, 0, 0, 0, -1.0 / 3.0}), gradient({0.4, 0, 0, 0, -1, 0, 0, 0, 0.2})};

// Particles at one free side, and from one to the other, among points that are as free.
TEST(SpacePoints, FreeSidesAreInBalance)
{
  const auto amid = [](const Vector<3>& x) {
    return (x.head<2>().array() > 1e-9).all() && (x.head<2>().array() < 1.0 - 1e-9).all();
  };
  for (const geom::Box<3>& box : {cells({3, 3, 5}, {7, 7, kCells}), cells({3, 4, 0}, {7, 8, kCells})}) {
    SpaceCube cube(cube_of_points({box}));
    for (const Tensor<3>& strain : kFree) EXPECT_LT(cube.unbalanced(affine(kSmall * strain), kSmall, amid), 1e-12);
    // Only the force of shear along the side is uniform, not its moment: a quarter of what is left with `volume`.
    const SpaceField shear = affine(kSmall * gradient({0, 1, 0, 1, 0, 0, 0, 0, 0}));
    EXPECT_LT(cube.unbalanced(shear, kSmall, amid), 0.03);
  }
}

// Rotation by half a radian about a slanted axis.
TEST(SpacePoints, RotationIsFreeOfForce)
{
  const Tensor<3> turn = Eigen::AngleAxisd(0.5, Vector<3>(1, 2, 3).normalized()).toRotationMatrix();
  for (const auto& boxes : {kBlock, kSlab, scattered()}) {
    SpaceCube cube(cube_of_points(boxes));
    EXPECT_LT(cube.unbalanced(affine(turn - Tensor<3>::Identity()), 1.0, everywhere), 1e-14);
  }
}

// Of any displacement: forces add up to nothing.
TEST(SpacePoints, ForcesKeepMomentum)
{
  SpaceCube cube(cube_of_points(scattered()));
  const std::vector<double> force = cube.force([](const Vector<3>& x) -> Vector<3> { return 1e-3 * noise(x); });
  Vector<3> sum = Vector<3>::Zero();
  double size = 0.0;
  for (Index row = 0; row < cube.rows(); ++row) {
    const Vector<3> f = Eigen::Map<const Vector<3>>(&force[static_cast<std::size_t>(3 * row)]);
    sum += f;
    size += f.norm();
  }
  for (int d = 0; d < 3; ++d) EXPECT_LT(std::abs(cube.sum(sum[d])), 1e-14 * cube.sum(size));
}

// A cube of density 1 has a mass of 1, whatever of it are particles.
TEST(SpacePoints, MassIsThatOfTheBody)
{
  for (const auto& boxes : {kBlock, kSlab, scattered()}) {
    SpaceCube cube(cube_of_points(boxes));
    std::vector<double> mass(static_cast<std::size_t>(cube.rows()), 0.0);
    for (const auto& term : cube.system().terms) term->add_mass(mass);
    double sum = 0.0;
    for (const double m : mass) sum += m;
    EXPECT_NEAR(cube.sum(sum), 1.0, 1e-13);
  }
}

// A quadratic, whose slopes central differences have exactly.
TEST(SpacePoints, ParticlesFillWithTheFieldOfTheirCells)
{
  SpaceCube cube(cube_of_points(kBlock));
  const SpaceField quadratic = [](const Vector<3>& x) -> Vector<3> {
    return {x[0] * x[0] - x[1] * x[2] + 1.0, x[1] * x[1] + x[2], x[0] * x[1] - 2.0 * x[2] * x[2]};
  };
  const adapt::SpaceCells some{{0, {1, 4, 4}}, {0, {5, 8, 8}}};
  const std::vector<double> u = cube.blocks(quadratic);
  const std::span<const double> fields[] = {u};
  const adapt::FreshRows fresh = adapt::fill(cube.view(), some, fields);
  EXPECT_EQ(cube.sum(static_cast<double>(fresh.names.size())), 16.0);
  for (std::size_t k = 0; k < fresh.names.size(); ++k) {
    const std::optional<Site<3>> site = cube.view().names[0].site(fresh.names[k].key());
    ASSERT_TRUE(site);
    const Vector<3> x = cube.view().bodies[0].place_of(*site), want = quadratic(x);
    for (int d = 0; d < 3; ++d) EXPECT_NEAR(fresh.fields[0][3 * k + static_cast<std::size_t>(d)], want[d], 1e-12);
  }
}

// Principal stress and stretch of a uniform strain are known; what surrounds one cell that asks comes along.
TEST(SpacePoints, BulkAsksByWhatItBears)
{
  SpaceCube cube(cube_of_points(kBlock));
  const law::Elastic& e = cube.elastic();
  const double strain = 0.01, stress = e.young * strain; // uniaxial along y
  const Tensor<3> pulled = Tensor<3>::Identity() + strain * gradient({-e.poisson, 0, 0, 0, 1, 0, 0, 0, -e.poisson});
  const Tensor<3> turn = Eigen::AngleAxisd(0.7, Vector<3>(3, 1, 2).normalized()).toRotationMatrix();
  const std::size_t all = kCells * kCells * kCells - 4 * 4 * 3;
  const auto converted = [&](const adapt::ConversionRule& rule, const SpaceField& field) {
    return adapt::conversion(cube.view(), adapt::SpaceWatch(cube.view(), rule), cube.blocks(field)).size();
  };
  for (const Tensor<3>& stretched : {pulled, Tensor<3>(turn * pulled)})
    for (const double share : {0.999, 1.001}) {
      adapt::ConversionRule by_stress, by_stretch;
      by_stress.stress = share * stress;
      by_stretch.stretch = share * strain;
      const SpaceField field = affine(stretched - Tensor<3>::Identity());
      EXPECT_EQ(converted(by_stress, field), share < 1.0 ? all : 0U);
      EXPECT_EQ(converted(by_stretch, field), share < 1.0 ? all : 0U);
    }
  // Strain in the layer of cells 1 to 2 along z alone.
  const SpaceField one = [](const Vector<3>& x) -> Vector<3> {
    return {0.0, 0.0, 0.02 * std::clamp(x[2] - kCell, 0.0, kCell)};
  };
  adapt::ConversionRule rule;
  rule.stretch = 0.015;
  for (const int margin : {0, 1, 2}) { // the third layer above meets the block of 16 columns
    rule.margin = margin;
    EXPECT_EQ(converted(rule, one),
              static_cast<std::size_t>(kCells * kCells * (1 + margin + std::min(margin, 1)) - (margin == 2 ? 16 : 0)));
  }
}
} // namespace pdx::space_points_test
