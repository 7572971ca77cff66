#include "pdx/solve/implicit_driver.hpp"

#include "pdx/base/events.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
std::span<const double> lend(Vec x, std::size_t size)
{
  const double* values = nullptr;
  PDX_CALL(VecGetArrayRead(x, &values));
  const std::span<const double> view{values, size};
  PDX_CALL(VecRestoreArrayRead(x, &values));
  return view;
}
} // namespace

ImplicitDriver::ImplicitDriver(field::System& system)
    : TimeDriver(system), tangent_(system, true), acceleration_(moving_.owned(), 0.0)
{
  make_ts(TSALPHA2);
  const double length = given_step();
  if (length == 0.0)
    throw UserError("-ts_dt is missing: an implicit step is as long as the event allows; give it in s");
  set_step(length);
  const VecHandle f = system.rows.vector();
  PDX_CALL(TSSetI2Function(ts_.get(), f.get(), residual, this));
  PDX_CALL(TSSetI2Jacobian(ts_.get(), tangent_.matrix(), tangent_.matrix(), jacobian, this));
  SNES snes = nullptr;
  KSP ksp = nullptr;
  PC pc = nullptr;
  PDX_CALL(TSGetSNES(ts_.get(), &snes));
  PDX_CALL(SNESSetType(snes, SNESNEWTONLS)); // not SNESKSPONLY: TSALPHA2 takes the velocity from the last residual
  PDX_CALL(SNESSetTolerances(snes, 1e-50, 1e-9, 1e-14, 50, 10000));
  PDX_CALL(SNESGetKSP(snes, &ksp));
  PDX_CALL(KSPSetType(ksp, KSPCG));
  PDX_CALL(KSPSetTolerances(ksp, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, 2000));
  PDX_CALL(KSPGetPC(ksp, &pc));
  PDX_CALL(PCSetType(pc, PCHYPRE));
  PDX_CALL(SNESSetFromOptions(snes));
}

/// M a + internal force - loads; where something is held, how far it is from where it should be. Forces are taken with
/// what is held in its place already: what is held and what is free then do not meet in the tangent, as it is
/// assembled.
PetscErrorCode ImplicitDriver::residual(TS, PetscReal time, Vec u, Vec, Vec a, Vec f, void* self)
{
  return guard([&] {
    auto& driver = *static_cast<ImplicitDriver*>(self);
    const field::System& system = driver.moving_.system;
    const std::size_t owned = driver.moving_.owned();
    const std::span<const double> tried = lend(u, owned);
    driver.local_ = driver.moving_.u; // the state between steps stays as it is
    std::ranges::copy(tried, driver.moving_.u.begin());
    driver.moving_.move(time, driver.moving_.u.data());
    double* values = nullptr;
    PDX_CALL(VecGetArray(f, &values));
    driver.moving_.unbalanced(time, {values, owned});
    driver.moving_.add_inertia(lend(a, owned), {values, owned});
    for (const Index c : system.prescribed.components)
      values[c] = system.scale * (tried[static_cast<std::size_t>(c)] - driver.moving_.u[static_cast<std::size_t>(c)]);
    field::project(system.rollers, system.rows.dim, values);
    for (const field::Roller& roller : system.rollers)
      roller.add(system.rows.dim, system.scale * roller.part(system.rows.dim, tried.data()), values);
    PDX_CALL(VecRestoreArray(f, &values));
    std::ranges::copy(driver.local_, driver.moving_.u.begin());
  });
}

PetscErrorCode ImplicitDriver::jacobian(TS, PetscReal, Vec u, Vec, Vec, PetscReal, PetscReal on_a, Mat, Mat, void* self)
{
  return guard([&] {
    auto& driver = *static_cast<ImplicitDriver*>(self);
    if (driver.moving_.system.linear() && driver.moving_.system.after_step.empty() && on_a == driver.factor_) return;
    driver.moving_.system.halo->gather(u, driver.local_);
    driver.tangent_.update(driver.local_);
    driver.add_mass(on_a);
    driver.factor_ = on_a;
  });
}

void ImplicitDriver::add_mass(double factor)
{
  const field::System& system = moving_.system;
  const auto dim = static_cast<std::size_t>(system.rows.dim);
  const Mat matrix = tangent_.matrix();
  const auto add = [&](std::size_t row, std::size_t column, double mass) {
    const PetscInt base = system.rows.first * static_cast<PetscInt>(dim);
    for (std::size_t d = 0; d < dim; ++d) {
      if (system.held[row * dim + d] || system.held[column * dim + d]) continue;
      PDX_CALL(MatSetValue(matrix, base + static_cast<PetscInt>(row * dim + d),
                           base + static_cast<PetscInt>(column * dim + d), factor * mass, ADD_VALUES));
    }
  };
  std::vector<double> own = moving_.mass;
  for (const field::Tie& t : moving_.ties()) {
    const auto row = static_cast<std::size_t>(t.row), set = static_cast<std::size_t>(t.set);
    const double far = moving_.mass[set];
    own[row] += far;
    own[set] = t.factor * t.factor * far;
    add(row, set, t.factor * far);
    add(set, row, t.factor * far);
  }
  for (std::size_t row = 0; row < own.size(); ++row) add(row, row, own[row]);
  take_mass_off_rollers(own, factor);
  PDX_CALL(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

/// What lies along a roller has no mass in the matrix.
void ImplicitDriver::take_mass_off_rollers(std::span<const double> own, double factor)
{
  const field::System& system = moving_.system;
  const PetscInt dim = system.rows.dim, base = system.rows.first * dim;
  for (const field::Roller& roller : system.rollers)
    for (PetscInt a = 0; a < dim; ++a)
      for (PetscInt b = 0; b < dim; ++b)
        PDX_CALL(MatSetValue(tangent_.matrix(), base + roller.row * dim + a, base + roller.row * dim + b,
                             -factor * own[static_cast<std::size_t>(roller.row)] * roller.along[a] * roller.along[b],
                             ADD_VALUES));
}

void ImplicitDriver::evaluate(double time, std::span<double> a)
{
  static Event event("time_acceleration");
  const Timed timed(event);
  moving_.move(time, moving_.u.data());
  moving_.move_velocity(time, moving_.v.data());
  moving_.unbalanced(time, a);
  moving_.accelerate(a);
}

void ImplicitDriver::start(double time, std::span<double> a) { evaluate(time, a); }

/// The method knows what is held in the middle of a step only: at its end it is put where it should be.
void ImplicitDriver::after_evaluations() { evaluate(time(), acceleration_); }

void ImplicitDriver::set_acceleration(const StepOrigin&, std::span<const double> a)
{
  std::ranges::copy(a, acceleration_.begin());
}
} // namespace pdx::solve
