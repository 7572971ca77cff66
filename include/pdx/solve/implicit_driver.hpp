#pragma once
#include "pdx/solve/tangent_operator.hpp"
#include "pdx/solve/time_driver.hpp"

namespace pdx::solve {
/// Implicit dynamics by PETSc's generalised alpha method (TSALPHA2, -ts_alpha_...), for smooth events that are long
/// against the stable step: the same Terms with their exact tangent and lumped mass. Without -ts_alpha_radius it is the
/// trapezoidal rule, which keeps the energy of a linear scene.
class ImplicitDriver final : public TimeDriver {
public:
  /// The Terms must assemble whole tangents. Throws UserError without -ts_dt or an end. Collective.
  explicit ImplicitDriver(field::System& system);

  std::span<const double> acceleration() const override { return acceleration_; }
  KineticEnergy kinetic_energy() const override { return moving_.kinetic_energy(acceleration_, 0.0); }
  int assemblies() const { return tangent_.assemblies(); }

private:
  static PetscErrorCode residual(TS, PetscReal time, Vec u, Vec v, Vec a, Vec f, void* self);
  static PetscErrorCode jacobian(TS, PetscReal time, Vec u, Vec v, Vec a, PetscReal on_v, PetscReal on_a, Mat, Mat,
                                 void* self);
  void add_mass(double factor);
  void take_mass_off_rollers(std::span<const double> own, double factor);
  void evaluate(double time, std::span<double> a);
  void set_acceleration(const StepOrigin&, std::span<const double> a) override;
  void start(double time, std::span<double> a) override;
  void let_go(const field::ForceLosses& losses) override { moving_.let_go(losses, acceleration_); }
  void after_evaluations() override;

  TangentOperator tangent_;
  std::vector<double> acceleration_, local_;
  double factor_ = -1.0; // of the mass in the matrix
};
} // namespace pdx::solve
