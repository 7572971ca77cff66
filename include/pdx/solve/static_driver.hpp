#pragma once
#include "pdx/solve/two_level.hpp"

#include <functional>

namespace pdx::solve {
/// How a static scene is solved; everything else is PETSc's (-snes_, -ksp_, -pc_, -mg_).
struct StaticOptions {
  int load_steps = 1;
  bool assembled = false; ///< one MATAIJ instead of the matrix-free two-level solver
};

/// What a run cost.
struct StaticReport {
  int steps = 0, newton_iterations = 0, linear_iterations = 0, jacobian_assemblies = 0, preconditioner_builds = 0;
  double seconds = 0.0;                   ///< assembly, set-up and solve [s]
  std::vector<std::vector<double>> norms; ///< residual norms of each step's Newton iterations [N]
};

/// Quasi-static equilibrium by SNES: for each load, solve; call back; go on.
class StaticDriver {
public:
  /// Sets up solver objects and reads PETSc's options. The system must be bound and outlive the driver. Collective.
  StaticDriver(const field::System& system, const StaticOptions& options);
  StaticDriver(const StaticDriver&) = delete;
  StaticDriver& operator=(const StaticDriver&) = delete;

  /// Called after each accepted load with its number (from 1) and the displacement.
  using Accepted = std::function<void(int step, Vec u)>;
  /// Runs all loads from the state in u. Throws SolverFailure (which step, why, what to try). Collective.
  void run(Vec u, const Accepted& accepted);
  const StaticReport& report() const { return report_; }
  SNES snes() const { return snes_.get(); }
  /// Residual of the free components and reactions at prescribed ones: internal force - load [N]. Collective.
  std::vector<double> unbalanced_force(Vec u, double load) const;

private:
  static PetscErrorCode residual(SNES, Vec u, Vec r, void* self);
  static PetscErrorCode jacobian(SNES, Vec u, Mat, Mat, void* self);
  static PetscErrorCode record(SNES, PetscInt iteration, PetscReal norm, void* self);
  void configure();
  void refuse_wrong_krylov(KSP ksp, PC pc) const;
  void solve(int step, Vec u);
  void attempt(Vec u);
  void prescribe(Vec u, double load) const;
  std::vector<double> unbalanced_force(std::span<const double> owned, double load) const;

  const field::System& system_;
  StaticOptions options_;
  TangentOperator tangent_;
  std::unique_ptr<TwoLevel> two_level_;
  SnesHandle snes_;
  double load_ = 0.0;
  mutable std::vector<double> local_;
  StaticReport report_;
};

/// The PC types that need no assembled matrix.
bool works_matrix_free(std::string_view pc_type);
} // namespace pdx::solve
