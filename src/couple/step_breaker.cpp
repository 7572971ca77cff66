#include "pdx/couple/step_breaker.hpp"

#include "pdx/base/events.hpp"

namespace pdx::couple {
StepBreaker::StepBreaker(pd::BondTerm<2>& bonds, CarriedBonds<2>* carried, const FractureOptions& options, Steps steps)
    : bonds_(bonds), carried_(carried), steps_(steps)
{
  for (const double stretch : options.critical_stretch) rules_.push_back({options.kinematics, stretch, nullptr});
  bonds_.protect(options.no_fail);
  if (steps_ == Steps::in_strips) bonds_.step_explicitly(rules_);
  if (carried_) carried_->watch(rules_);
  StepBreaker::save();
}

void StepBreaker::apply(std::span<const double> u, field::ForceLosses& losses)
{
  static Event event("pd_break");
  if (steps_ == Steps::as_terms) {
    const Timed timed(event);
    now_ += bonds_.break_bonds(bonds_.load(u), rules_);
  } else if (bonds_.overstretched_seen())
    now_ += bonds_.break_overstretched(&losses);
  if (carried_ && carried_->overstretched_seen()) now_ += carried_->break_bonds(u, rules_, &losses);
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
