#include "pdx/solve/static_solver.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::solve {
namespace {
constexpr int kFewestSolves = 4; // that repay the elimination: it costs 2 to 3 of them
/// A product with the dense matrix costs as much as the eliminated elements would where its size squared is this many
/// times their number of components.
constexpr double kDensest = 60.0;
constexpr std::int64_t kMostKept = 8000; // components: half a gigabyte
} // namespace

StaticSolver::StaticSolver(const field::System& system, const StaticOptions& options, StaticReport before,
                           Lasting* lasting)
    : system_(system)
{
  condense(options, before.solves == 0, lasting);
  driver_ = std::make_unique<StaticDriver>(condensed_ ? condensed_->system() : system_, options, std::move(before));
}

/// @param begins a run that asked for it is told at once; a later layout may leave nothing to eliminate
void StaticSolver::condense(const StaticOptions& options, bool begins, Lasting* lasting)
{
  told_.why_not = reason_against(options);
  if (options.condense == Condense::on && !told_.why_not.empty() && begins)
    throw UserError(fmt::format("-static_condense on is not possible here: {}; use auto or off", told_.why_not));
  if (told_.why_not.empty()) {
    Border border = border_of(system_);
    told_.kept = border.kept_components;
    told_.eliminated = border.eliminated_components;
    told_.why_not = judge(border, options);
    if (told_.why_not.empty()) {
      condensation_ = std::make_unique<Condensation>(system_, std::move(border), lasting);
      told_.why_not = condensation_->fault();
    }
  }
  if (told_.why_not.empty()) {
    condensed_ = std::make_unique<CondensedSystem>(system_, *condensation_);
    return;
  }
  condensation_.reset();
}

/// What a look at the System tells.
std::string StaticSolver::reason_against(const StaticOptions& options) const
{
  if (options.condense == Condense::off) return "-static_condense off";
  if (options.assembled || !system_.coarse) return "the tangent is assembled";
  if (system_.swelling) return "heat strains the elements";
  if (!system_.turning.empty()) return "something is turned";
  if (!system_.symmetric()) return "the tangent is not symmetric";
  if (std::ranges::none_of(system_.terms, [](const auto& term) { return term->fixed(); }))
    return "no elements of small strain";
  if (options.condense == Condense::automatic && system_.after.empty() && options.load_steps < kFewestSolves)
    return "too few solves to repay it";
  return "";
}

std::string StaticSolver::judge(const Border& border, const StaticOptions& options) const
{
  if (border.eliminated_components == 0 || border.kept_components == 0) return "no elements away from particles";
  if (border.kept_components > kMostKept) return "too many elements touch particles for a dense matrix of them";
  if (options.condense == Condense::on) return "";
  const auto kept = static_cast<double>(border.kept_components);
  if (kept * kept > kDensest * static_cast<double>(border.eliminated_components))
    return "too many elements touch particles for the others to count";
  return "";
}

void StaticSolver::run(Vec u, const StaticDriver::Accepted& accepted)
{
  LoadPath all = path();
  run(u, all, accepted);
}

/// A run that ends by an exception leaves u as it was accepted last.
Verdict StaticSolver::run(Vec u, LoadPath& path, const StaticDriver::Accepted& accepted, std::optional<OpenStep>* open)
{
  if (!condensed_) return driver_->run(u, path, accepted, open);
  const VecHandle v = condensed_->system().rows.vector();
  condensed_->narrow(u, v.get());
  std::vector<double> start = field::owned_values(u); // of the load accepted last
  if (open && *open) {
    start = (*open)->start;
    (*open)->start = condensed_->narrowed(start);
  }
  const Verdict verdict = driver_->run(
      v.get(), path,
      [&](const Step& step, Vec state) {
        condensed_->recover(state, step.load, u);
        start = field::owned_values(u);
        return accepted(step, u);
      },
      open);
  if (open && *open) { // within a load
    condensed_->recover(v.get(), (*open)->step.load, u);
    (*open)->start = std::move(start);
  }
  return verdict;
}

std::vector<double> StaticSolver::unbalanced_force(Vec u, double load) const
{
  std::vector<double> local;
  return solve::unbalanced_force(system_, field::owned_values(u), load, local);
}
} // namespace pdx::solve
