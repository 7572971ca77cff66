#include "support/scene.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using couple::Scheme;

namespace {
struct Case {
  Scheme scheme;
  options::KinematicsOption kinematics;
  bool surface = false; ///< volume method everywhere, the papers' constants
  bool cracked = false; ///< by a crack through elements into a patch, and by bonds that broke
};

const std::vector<Case>& cases()
{
  using options::KinematicsOption;
  static const std::vector<Case> all = [] {
    std::vector<Case> list;
    for (const Scheme scheme : {Scheme::energy, Scheme::ghost, Scheme::interface})
      for (const KinematicsOption kinematics :
           {KinematicsOption::small, KinematicsOption::finite, KinematicsOption::mixed})
        for (const bool surface : {false, true})
          for (const bool cracked : {false, true}) list.push_back({scheme, kinematics, surface, cracked});
    return list;
  }();
  return all;
}

std::string name(const Case& c)
{
  const char* schemes[] = {"energy", "ghost", "interface"};
  const char* kinematics[] = {"small", "finite", "mixed"};
  return std::string(schemes[static_cast<int>(c.scheme)]) + ", " + kinematics[static_cast<int>(c.kinematics)] +
         (c.surface ? ", surface correction" : "") + (c.cracked ? ", cracked" : "");
}

/// One patch inside, one that reaches the free right side of the plate, which is held on the left.
options::SceneOptions plate(const Case& c)
{
  auto options = test::held_plate({10, 8}, {{0.0, 0.0}, {1.0, 0.8}});
  options.conditions.resize(1); // left
  options = test::with_patch(options, {{0.2, 0.2}, {0.5, 0.6}}, 0.05);
  options = test::with_patch(options, {{0.8, 0.3}, {1.0, 0.6}}, 0.05);
  options.scheme = c.scheme;
  options.kinematics = c.kinematics;
  if (c.surface) {
    options.pd.calibration = pd::Calibration::continuum;
    options.pd.surface_correction = options::SurfaceCorrection::volume;
  }
  if (c.cracked) {
    options.cracks.lines = {{{0.0, 0.45}, {0.37, 0.41}}};
    options.fracture.critical_stretch = 0.08;
  }
  return options;
}

/// A displacement with strains of about ten per cent and no pattern.
test::Field wild(std::uint64_t seed, double size = 5e-3)
{
  return [field = test::noise(seed), size](const Vector<2>& x) -> Vector<2> { return size * field(x); };
}

/// The plate with, if cracked, some of its bonds broken.
std::unique_ptr<test::Scene> make(const Case& c, bool assembled = false, MPI_Comm comm = PETSC_COMM_WORLD)
{
  auto scene = std::make_unique<test::Scene>(plate(c), assembled, comm);
  scene::Discretisation& d = scene->d();
  EXPECT_EQ(d.cut_elements != nullptr, c.cracked);
  if (!c.cracked) return scene;
  const auto u = scene->blocks(wild(4));
  const std::int64_t broken = d.fracture->apply(u);
  EXPECT_GT(broken, 20) << name(c);
  EXPECT_LT(broken, d.bonds_at_start / 2) << name(c);
  return scene;
}

/// The same field, 0 at prescribed components.
VecHandle free_part(test::Scene& scene, const test::Field& field)
{
  VecHandle v = scene.vector(field);
  double* values = nullptr;
  PDX_CALL(VecGetArray(v.get(), &values));
  for (const Index k : scene.system().prescribed.components) values[k] = 0.0;
  PDX_CALL(VecRestoreArray(v.get(), &values));
  return v;
}

double dot(Vec a, Vec b)
{
  double value = 0.0;
  PDX_CALL(VecDot(a, b, &value));
  return value;
}

double norm(Vec a) { return std::sqrt(dot(a, a)); }

VecHandle product(Mat matrix, Vec x)
{
  VecHandle y;
  PDX_CALL(VecDuplicate(x, y.out()));
  PDX_CALL(MatMult(matrix, x, y.get()));
  return y;
}
} // namespace

TEST(Tangent, MatrixFreeAndAssembledAreTheSame)
{
  for (const Case& c : cases()) {
    const auto first = make(c), second = make(c, true);
    test::Scene &free = *first, &whole = *second;
    solve::TangentOperator shell(free.system(), false), matrix(whole.system(), true);
    shell.update(free.blocks(wild(1)));
    matrix.update(whole.blocks(wild(1)));
    EXPECT_FALSE(shell.assembled());
    for (const std::uint64_t seed : {2u, 3u}) {
      const VecHandle x = free.vector(wild(seed, 1.0)); // not 0 at prescribed components
      const VecHandle a = product(shell.matrix(), x.get()), b = product(matrix.matrix(), x.get());
      const double size = norm(b.get());
      EXPECT_GT(size, 1.0);
      PDX_CALL(VecAXPY(a.get(), -1.0, b.get()));
      EXPECT_LT(norm(a.get()), 1e-12 * size) << name(c);
    }
  }
}

TEST(Tangent, SymmetricInTheEnergyAndGhostSchemesOnly)
{
  for (const Case& c : cases()) {
    const auto made = make(c);
    test::Scene& scene = *made;
    solve::TangentOperator tangent(scene.system(), false);
    tangent.update(scene.blocks(wild(1)));
    const VecHandle x = scene.vector(wild(2, 1.0)), y = scene.vector(wild(3, 1.0));
    const VecHandle ax = product(tangent.matrix(), x.get()), ay = product(tangent.matrix(), y.get());
    const double gap = std::abs(dot(y.get(), ax.get()) - dot(x.get(), ay.get())) / (norm(x.get()) * norm(ay.get()));
    EXPECT_EQ(scene.system().symmetric(), c.scheme != Scheme::interface) << name(c);
    EXPECT_EQ(gap < 1e-14, c.scheme != Scheme::interface) << name(c) << ": " << gap;
  }
}

TEST(Tangent, IsTheChangeOfTheForce)
{
  constexpr double kStep = 1e-6;
  for (const Case& c : cases()) {
    const auto made = make(c);
    test::Scene& scene = *made;
    solve::TangentOperator tangent(scene.system(), false);
    tangent.update(scene.blocks(wild(1)));
    const VecHandle v = free_part(scene, wild(2, 1.0)), kv = product(tangent.matrix(), v.get());
    const auto force_at = [&](double step) {
      VecHandle u = scene.vector(wild(1));
      PDX_CALL(VecAXPY(u.get(), step, v.get()));
      std::vector<double> local;
      scene.system().halo->gather(u.get(), local);
      return scene.internal_force(local);
    };
    const std::vector<double> after = force_at(kStep), before = force_at(-kStep);
    const double* found = nullptr;
    double gap = 0.0, size = 0.0;
    PDX_CALL(VecGetArrayRead(kv.get(), &found));
    for (std::size_t k = 0; k < after.size(); ++k) {
      if (scene.system().held[k]) continue;
      gap = std::max(gap, std::abs((after[k] - before[k]) / (2.0 * kStep) - found[k]));
      size = std::max(size, std::abs(found[k]));
    }
    PDX_CALL(VecRestoreArrayRead(kv.get(), &found));
    EXPECT_GT(scene.max(size), 0.1) << name(c);
    EXPECT_LT(scene.max(gap), 2e-8 * scene.max(size)) << name(c);
  }
}

TEST(Tangent, ForceIsTheChangeOfTheEnergy)
{
  constexpr double kStep = 1e-5;
  for (const Case& c : cases()) {
    if (c.scheme == Scheme::interface) continue; // has no energy
    const auto made = make(c);
    test::Scene& scene = *made;
    const VecHandle v = scene.vector(wild(2, 1e-2)); // in all components: nothing is held here
    const auto energy_at = [&](double step) {
      VecHandle u = scene.vector(wild(1));
      PDX_CALL(VecAXPY(u.get(), step, v.get()));
      std::vector<double> local;
      scene.system().halo->gather(u.get(), local);
      return scene.energy(local);
    };
    const std::vector<double> force = scene.internal_force(scene.blocks(wild(1)));
    const std::vector<double> direction = scene.blocks(wild(2, 1e-2));
    double work = 0.0;
    for (std::size_t k = 0; k < force.size(); ++k) work += force[k] * direction[k];
    work = scene.sum(work);
    EXPECT_GT(std::abs(work), 1e-6) << name(c);
    EXPECT_NEAR((energy_at(kStep) - energy_at(-kStep)) / (2.0 * kStep), work, 1e-7 * std::abs(work)) << name(c);
  }
}

TEST(Tangent, EnergyDoesNotDependOnTheNumberOfRanks)
{
  for (const Case& c : cases()) {
    const auto energy = [&](MPI_Comm comm) {
      const auto scene = make(c, false, comm);
      return scene->energy(scene->blocks(wild(1)));
    };
    const double alone = test::on_one_rank(energy);
    EXPECT_GT(alone, 1e-5) << name(c);
    EXPECT_NEAR(energy(PETSC_COMM_WORLD), alone, 1e-13 * alone) << name(c);
  }
}
