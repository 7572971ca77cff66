#include "pdx/couple/step_breaker.hpp"

#include "pdx/base/events.hpp"

namespace pdx::couple {
StepBreaker::StepBreaker(pd::BondTerm<2>& bonds, CarriedBonds<2>* carried, const FractureOptions& options)
    : bonds_(bonds), carried_(carried)
{
  for (const double stretch : options.critical_stretch) rules_.push_back({options.kinematics, stretch, nullptr});
  bonds_.protect(options.no_fail);
  StepBreaker::save();
}

void StepBreaker::apply(std::span<const double> u)
{
  static Event event("pd_break");
  const Timed timed(event);
  const auto& loaded = bonds_.load(u);
  now_ += bonds_.break_bonds(loaded, rules_);
  if (carried_) now_ += carried_->break_bonds(u, rules_);
}

void StepBreaker::save()
{
  bonds_.save();
  if (carried_) carried_->save();
  saved_ = now_;
}

void StepBreaker::restore()
{
  bonds_.restore();
  if (carried_) carried_->restore();
  now_ = saved_;
}
} // namespace pdx::couple
