#include "support/cracked.hpp"
#include "support/frequencies.hpp"

#include <gtest/gtest.h>

namespace pdx::test {
namespace {
constexpr double kDensity = 7.0; // [kg/m^3]

options::SceneOptions dense(options::SceneOptions options)
{
  options.elastic.density = kDensity;
  options.time.analysis = options::Analysis::implicit_dynamics; // a part that a crack cuts off needs no supports
  return options;
}

/// An n x n plate, all around free, with a patch of 2 x 2 to 4 x 4 elements at `ratio` particles per element.
options::SceneOptions coupled(Index n, Index first, Index last, double ratio)
{
  options::SceneOptions options = dense(held_plate({n, n}));
  options.conditions.resize(1);
  const double h = 1.0 / n;
  return with_patch(options, {{first * h, first * h}, {last * h, last * h}}, h / ratio);
}

struct Limits {
  double bound, exact; ///< [s]
  Vector<2> place;     ///< of the row that decides [m]
};

/// On one rank, whichever that is.
Limits limits_of(const options::SceneOptions& options)
{
  Scene scene(options, false, PETSC_COMM_SELF);
  EXPECT_TRUE(scene.system().linear());
  const solve::StableStep step = solve::stable_step(scene.system());
  return {step.limit, true_limit(scene.system()), {step.place[0], step.place[1]}};
}

/// Bound and exact limit, the former not above the latter and at least `least` of it.
void expect_rigorous(const std::string& name, const options::SceneOptions& options, double least)
{
  const auto [bound, exact, place] = limits_of(options);
  EXPECT_LE(bound, exact * (1.0 + 1e-10)) << name;
  EXPECT_GE(bound, least * exact) << name;
  const double speed = std::sqrt(options.elastic.c11() / kDensity); // c_L
  const double h = options.pd.any() ? options.pd.spacing[0] : 1.0 / options.mesh.cells[0];
  if (std::getenv("PDX_SHOW"))
    std::printf("%-28s bound %.4f exact %.4f (h or dx)/c_L, ratio %.4f at (%.4f, %.4f)\n", name.c_str(),
                bound * speed / h, exact * speed / h, bound / exact, place.x(), place.y());
}

TEST(StableStep, OfAPlateOfElementsIsSharp)
{
  options::SceneOptions options = dense(held_plate({10, 10}));
  expect_rigorous("elements, held", options, 0.84);
  options.conditions.resize(1);
  expect_rigorous("elements, one side held", options, 0.84);
}

TEST(StableStep, OfParticlesIsRigorous)
{
  for (const double m : {3.0, 4.0, 6.0}) {
    options::SceneOptions options = dense(held_particles(28));
    options.pd.horizon_ratio = m;
    expect_rigorous("particles, conical " + std::to_string(m), options, 0.75);
  }
  options::SceneOptions options = dense(held_particles(28));
  options.pd.horizon_ratio = 3.0;
  options.pd.micromodulus = law::Micromodulus::uniform;
  expect_rigorous("particles, uniform 3", options, 0.75);
}

TEST(StableStep, OfCoupledPlatesIsRigorous)
{
  for (const auto scheme : {couple::Scheme::energy, couple::Scheme::ghost}) {
    const std::string name = scheme == couple::Scheme::ghost ? "ghost" : "energy";
    for (const double ratio : {2.0, 4.0, 5.0}) {
      options::SceneOptions options = ratio == 2.0 ? coupled(10, 3, 8, ratio) : coupled(9, 3, 6, ratio);
      options.scheme = scheme;
      expect_rigorous(name + " h/dx = " + std::to_string(ratio), options, 0.5);
    }
  }
}

TEST(StableStep, OfCutPlatesIsRigorous)
{
  for (const double angle : {0.0, 0.3, 0.8})
    for (const double y : {0.5, 0.4501, 0.4999}) {
      options::SceneOptions options = dense(held_plate({10, 10}));
      options.conditions.resize(1);
      options.cracks.lines = {through_crack({0.51, y}, angle)};
      expect_rigorous("cut at " + std::to_string(angle) + ", " + std::to_string(y), options, 0.55);
      options.pd.patches.push_back({{0.5, 0.2}, {0.9, 0.8}});
      options.pd.spacing.push_back(0.1 / 3.0);
      expect_rigorous("cut, patch " + std::to_string(angle) + ", " + std::to_string(y), options, 0.6);
    }
}

double bound_of(const options::SceneOptions& options)
{
  Scene scene(options, false, PETSC_COMM_SELF);
  return solve::stable_step(scene.system()).limit;
}

/// Bounds relative to the same plate without a crack: the smallest over all cracks given.
double worst_share(options::SceneOptions options, const std::vector<crack::Polyline>& cracks)
{
  const double whole = bound_of(options);
  double worst = 1.0;
  for (const crack::Polyline& line : cracks) {
    options.cracks.lines = {line};
    worst = std::min(worst, bound_of(options) / whole);
  }
  if (std::getenv("PDX_SHOW")) std::printf("worst of %zu cracks: %.4f\n", cracks.size(), worst);
  return worst;
}

/// Cracks past a node in the middle, from 1e-1 to 1e-14 elements away on either side.
std::vector<crack::Polyline> cracks_near_a_node(const std::vector<double>& angles)
{
  std::vector<crack::Polyline> cracks;
  for (const double angle : angles)
    for (int digits = 1; digits <= 14; ++digits)
      for (const int sign : {1, -1})
        cracks.push_back(through_crack({0.5, 0.5 + sign * 0.1 * std::pow(10.0, -digits)}, angle));
  return cracks;
}

options::SceneOptions free_plate()
{
  options::SceneOptions options = dense(held_plate({10, 10}));
  options.conditions.resize(1);
  return options;
}

TEST(StableStep, StaysAboveABoundWhereverTheCrackRuns)
{
  std::vector<crack::Polyline> cracks = cracks_near_a_node({0.0, 0.1, 0.3, 0.7853981633974483, 1.2});
  std::mt19937 random(20261122);
  std::uniform_real_distribution<double> place(0.1, 0.9), angle(0.0, 3.14159265358979);
  for (int k = 0; k < 200; ++k) {
    const double x = place(random), y = place(random);
    cracks.push_back(through_crack({x, y}, angle(random)));
  }
  EXPECT_GT(worst_share(free_plate(), cracks), 0.6);
}

TEST(StableStep, StaysAboveABoundWhereCracksEnterAPatch)
{
  for (const double ratio : {2.0, 4.0}) {
    const options::SceneOptions options = with_patch(free_plate(), {{0.5, 0.2}, {0.9, 0.8}}, 0.1 / ratio);
    EXPECT_GT(worst_share(options, cracks_near_a_node({0.0, 0.1, 0.3, 0.7853981633974483})), 0.5) << ratio;
  }
}

/// A crack that runs along a patch leaves a strip of elements on its interface that weighs little and carries all bonds
/// there: the body does have such a frequency, and the step says where.
TEST(StableStep, NamesTheStripBetweenAPatchAndACrackAlongIt)
{
  options::SceneOptions options = with_patch(free_plate(), {{0.5, 0.2}, {0.9, 0.8}}, 0.05);
  const double whole = bound_of(options);
  options.cracks.lines = {through_crack({0.894, 0.551}, 1.6074)};
  const auto [bound, exact, place] = limits_of(options);
  EXPECT_LE(bound, exact);
  EXPECT_LT(exact, 0.4 * whole);
  EXPECT_NEAR(place.x(), 0.9, 1e-12);
}
} // namespace
} // namespace pdx::test
