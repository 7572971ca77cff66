#include "pdx/couple/step_breaker.hpp"

#include "pdx/base/events.hpp"

namespace pdx::couple {
template <int Dim>
StepBreaker<Dim>::StepBreaker(pd::BondTerm<Dim>& bonds, CarriedBonds<Dim>* carried, const FractureRule& options,
                              Steps steps)
    : bonds_(bonds), carried_(carried), steps_(steps)
{
  for (const double stretch : options.critical_stretch) rules_.push_back({options.kinematics, stretch, nullptr});
  bonds_.protect(options.no_fail);
  if (steps_ == Steps::in_strips) bonds_.step_explicitly(rules_);
  if (carried_) carried_->watch(rules_);
  if (carried_ && steps_ == Steps::in_strips) carried_->step_explicitly();
  StepBreaker<Dim>::save();
}

template <int Dim> void StepBreaker<Dim>::apply(std::span<const double> u, field::ForceLosses& losses)
{
  static Event event("pd_break");
  if (steps_ == Steps::as_terms) {
    const Timed timed(event);
    this->now_ += bonds_.break_bonds(bonds_.load(u), rules_);
  } else if (bonds_.overstretched_seen())
    this->now_ += bonds_.break_overstretched(&losses);
  if (carried_ && carried_->overstretched_seen()) this->now_ += carried_->break_bonds(u, rules_, &losses);
}

template <int Dim> void StepBreaker<Dim>::save()
{
  bonds_.save();
  if (carried_) carried_->save();
  this->saved_ = this->now_;
}

template <int Dim> void StepBreaker<Dim>::restore()
{
  bonds_.restore();
  if (carried_) carried_->restore();
  this->now_ = this->saved_;
}

template class StepBreaker<2>;
template class StepBreaker<3>;

template <int Dim>
CloudBreaker<Dim>::CloudBreaker(pd::CloudTerm<Dim>& bonds, double critical_stretch,
                                std::span<const geom::Box<2>> no_fail)
    : bonds_(bonds)
{
  bonds_.watch(critical_stretch, no_fail);
  CloudBreaker<Dim>::save();
}

template <int Dim> void CloudBreaker<Dim>::apply(std::span<const double> u, field::ForceLosses& losses)
{
  if (bonds_.overstretched_seen()) this->now_ += bonds_.break_overstretched(u, losses);
}

template <int Dim> void CloudBreaker<Dim>::save()
{
  bonds_.save();
  this->saved_ = this->now_;
}

template <int Dim> void CloudBreaker<Dim>::restore()
{
  bonds_.restore();
  this->now_ = this->saved_;
}

template class CloudBreaker<2>;
template class CloudBreaker<3>;
} // namespace pdx::couple
