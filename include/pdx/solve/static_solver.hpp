#pragma once
#include "pdx/solve/condensed_system.hpp"
#include "pdx/solve/static_driver.hpp"

namespace pdx::solve {
/// What became of the condensation of a System.
struct CondensationReport {
  std::string why_not;         ///< empty: the System is condensed
  std::int64_t kept = 0;       ///< components of elements that stay unknowns; 0 if it was not looked at
  std::int64_t eliminated = 0; ///< components [-]
};

/// A static scene solved by a StaticDriver: as it is, or condensed, where many solves repay that. Whoever asks sees the
/// whole scene. Displacements of eliminated rows are worked out for accepted loads and where a layout changes.
class StaticSolver {
public:
  /// As that of StaticDriver. Throws UserError if condensation is asked for of what is never condensed. Collective.
  /// @param lasting what solvers of other layouts leave for those after them; null: there are none
  StaticSolver(const field::System& system, const StaticOptions& options, StaticReport before = {},
               Lasting* lasting = nullptr);

  Verdict run(Vec u, LoadPath& path, const StaticDriver::Accepted& accepted, std::optional<OpenStep>* open = nullptr);
  void run(Vec u, const StaticDriver::Accepted& accepted);
  LoadPath path() const { return driver_->path(); }
  const StaticReport& report() const { return driver_->report(); }
  const CondensationReport& condensation() const { return told_; }
  /// As that of StaticDriver, of the whole scene.
  std::vector<double> unbalanced_force(Vec u, double load) const;

private:
  void condense(const StaticOptions& options, bool begins, Lasting* lasting);
  std::string reason_against(const StaticOptions& options) const;
  std::string judge(const Border& border, const StaticOptions& options) const;

  const field::System& system_;
  CondensationReport told_;
  std::unique_ptr<Condensation> condensation_; // null: as it is
  std::unique_ptr<CondensedSystem> condensed_;
  std::unique_ptr<StaticDriver> driver_;
};
} // namespace pdx::solve
