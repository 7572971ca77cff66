#pragma once
#include "pdx/base/stop_signals.hpp"
#include "pdx/solve/keep_rule.hpp"
#include "pdx/solve/krylov_rules.hpp"
#include "pdx/solve/load_path.hpp"
#include "pdx/solve/two_level.hpp"
#include "pdx/solve/verdict.hpp"

#include <functional>
#include <optional>

namespace pdx::solve {
struct Step;

/// Are rows that nothing but fixed Terms touch eliminated before the solves?
enum class Condense { automatic, on, off };

/// How a static scene is solved; everything else is PETSc's (-snes_, -ksp_, -pc_, -mg_).
struct StaticOptions {
  int load_steps = 1;
  bool assembled = false;  ///< one MATAIJ instead of the matrix-free two-level solver
  bool full_steps = false; ///< of Newton: what comes to touch or parts makes kinks that searches along a line stop at
  Condense condense = Condense::automatic; ///< see StaticSolver
  int max_passes = 1000;                   ///< solves at one load; more: the increment is halved
  std::int64_t max_changes = 0;            ///< of an increment; more: it is halved; 0: no limit
  int max_halvings = 6;                    ///< of an original increment, at most 30
  double rebuild_factor = 1.3; ///< growth of iterations at which the preconditioner is built anew, see KeepRule
  /// Asked after AfterSolves changed something, before the next solve: throws if the scene can no longer be solved.
  std::function<void()> judge = {};
  /// Told after each solve of a load that is not quiet, and when a load is given up to be tried with half the
  /// increment.
  std::function<void(const Step&)> working = {};
  /// Asked likewise behind that: true if the layout is to change before the next solve.
  std::function<bool()> outgrown = {};
};

/// What a run cost.
struct StaticReport {
  int steps = 0, newton_iterations = 0, linear_iterations = 0, jacobian_assemblies = 0, preconditioner_builds = 0;
  int solves = 0;                          ///< of SNES, those of rejected increments and repeated ones included
  int passes = 0;                          ///< solves that accepted steps took, the quiet ones included
  int halvings = 0;                        ///< increments that were rejected and tried with half their size
  std::int64_t changes = 0;                ///< by AfterSolves in accepted steps
  std::int64_t held_rows = 0;              ///< rows without stiffness in some direction, at the last tangent
  double seconds = 0.0;                    ///< assembly, set-up and solve [s]
  std::vector<int> solve_iterations;       ///< linear iterations of each solve
  std::vector<double> solve_seconds;       ///< of each solve, assembly and set-up included [s]
  std::vector<std::int64_t> solve_changes; ///< by AfterSolves after each solve
  std::vector<std::vector<double>> norms;  ///< residual norms of each solve's Newton iterations [N]
};

/// An accepted load.
struct Step {
  int number = 0;           ///< accepted steps so far, this one included
  double load = 0.0;        ///< [-]
  int passes = 0;           ///< solves at this load; 1: quiet at once
  std::int64_t changes = 0; ///< by AfterSolves at this load
  int iterations = 0;       ///< of the linear solver at this load
};

/// A load that a driver was in the middle of when the layout was to change, for the next driver.
struct OpenStep {
  Step step;                 ///< as far as it came
  std::vector<double> start; ///< owned displacement accepted last; AfterSolves have saved what belongs to it [m]
};

/// Residual of the free components and reactions at prescribed ones: internal force - load [N]. Collective.
/// @param owned displacement [m]   @param local room for it with its halo
std::vector<double> unbalanced_force(const field::System& system, std::span<const double> owned, double load,
                                     std::vector<double>& local);

/// Quasi-static equilibrium by SNES: for each load, solve and ask the AfterSolves, again until they are quiet; call
/// back; go on. A load that cannot be reached is approached by halves.
class StaticDriver {
public:
  /// Sets up solver objects and reads PETSc's options. The system must be bound and outlive the driver. Collective.
  /// @param before what drivers of other layouts have done of the same load path
  StaticDriver(const field::System& system, const StaticOptions& options, StaticReport before = {});
  StaticDriver(const StaticDriver&) = delete;
  StaticDriver& operator=(const StaticDriver&) = delete;

  /// Called after each accepted load with the displacement.
  using Accepted = std::function<Verdict(const Step& step, Vec u)>;
  /// Runs the loads that are left of a path from the state in u, until `accepted` says otherwise, and returns what it
  /// said last. Throws SolverFailure (which load, why, what to try), what `judge` throws, or
  /// Stopped when a signal came; u and the AfterSolves are then in the state accepted last. Where `outgrown` says so,
  /// it leaves within a load. Collective.
  /// @param open what another driver left within a load; what this one leaves
  Verdict run(Vec u, LoadPath& path, const Accepted& accepted, std::optional<OpenStep>* open = nullptr);
  /// All loads.
  void run(Vec u, const Accepted& accepted);
  /// The path that `run` begins with by itself.
  LoadPath path() const { return {options_.load_steps, options_.max_halvings}; }
  const StaticReport& report() const { return report_; }
  SNES snes() const { return snes_.get(); }

private:
  static PetscErrorCode residual(SNES, Vec u, Vec r, void* self);
  static PetscErrorCode jacobian(SNES, Vec u, Mat, Mat, void* self);
  static PetscErrorCode look(KSP, PetscInt iteration, PetscReal norm, void* self);
  static PetscErrorCode record(SNES, PetscInt iteration, PetscReal norm, void* self);
  void configure();
  std::string attempted(Step& step, Vec saved, Vec u);
  std::string equilibrium(Step& step, Vec u);
  Step begin(Vec u, Vec saved, const LoadPath& path, std::optional<OpenStep>* open);
  std::string solve(Vec u);
  std::string repeat(Vec u);
  std::string attempt(Vec u);
  void prepare(Vec u);
  void renew_preconditioner();
  void judge_preconditioner(double first_residual);
  bool preconditioner_is_behind() const { return built_at_ != tangent_.assemblies(); }
  void set_tolerances(std::span<const double> force, std::span<const double> residual);
  void restore(Vec saved, Vec u, bool changed);
  void prescribe(Vec u, double load) const;

  const field::System& system_;
  StaticOptions options_;
  TangentOperator tangent_;
  std::unique_ptr<TwoLevel> two_level_;
  SnesHandle snes_;
  KSP ksp_ = nullptr;                                        // of snes_
  PC pc_ = nullptr;                                          // of ksp_
  bool lags_jacobian_ = false, lags_preconditioner_ = false; // the user chose
  bool follows_ = false;                                     // the preconditioner is built anew with each tangent
  bool own_krylov_tolerance_ = false, own_newton_tolerance_ = false;
  bool outgrown_ = false;         // the layout is to change within this load
  bool new_load_ = false;         // the next residual is the first at its load
  bool stale_ = true;             // Terms changed since the last tangent
  bool tangent_is_there_ = false; // for the next iterate
  StopLook look_;                 // in each iteration of the linear solver
  KeepRule rule_;
  int built_at_ = 0; // assemblies of the tangent at the last build of the preconditioner
  std::int64_t held_at_build_ = 0;
  VecHandle start_;
  double load_ = 0.0, reached_ = 0.0; // tried now, accepted last
  mutable std::vector<double> local_;
  StaticReport report_;
  int assemblies_before_; // by other drivers
};
} // namespace pdx::solve
