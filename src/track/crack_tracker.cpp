#include "pdx/track/crack_tracker.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>

namespace pdx::track {
namespace {
constexpr double kDamageRounding = 1e-9; // of damage: sums of volumes in another order

std::vector<CrackStart> starts_of(std::span<const crack::Tip> tips)
{
  std::vector<CrackStart> starts;
  for (const crack::Tip& tip : tips) starts.push_back({tip.at, tip.direction});
  return starts;
}
} // namespace

CrackTracker::CrackTracker(MPI_Comm comm, std::span<const crack::Tip> tips, std::vector<TreeGround> grounds,
                           double threshold)
    : comm_(comm), threshold_(threshold), tree_(starts_of(tips), std::move(grounds))
{
  tips_ = tree_.tips();
  now_.tips = static_cast<int>(tips_.size());
}

void CrackTracker::look(double time, std::span<const double> damage, const NameOf& name)
{
  std::vector<Arrival> mine;
  for (std::size_t k = 0; k < before_.size(); ++k) {
    const double near = threshold_ - kDamageRounding;
    if (damage[k] < near || before_[k] >= near || before_[k] < 0.0) continue;
    if (tree_.has(name(k))) continue;    // it was gone, and came again
    if (!tree_.place(name(k))) continue; // of a body that no crack was given in, and that became particles later
    const double share = std::min(1.0, (threshold_ - before_[k]) / (damage[k] - before_[k]));
    mine.push_back({name(k), time_ + share * (time - time_)});
  }
  before_.assign(damage.begin(), damage.end());
  std::vector<Arrival> all = gather_all(comm_, mine);
  if (!all.empty()) {
    per_look_.push_back(static_cast<int>(all.size()));
    tree_.add(std::move(all));
    tips_ = tree_.tips();
  }
  judge(time);
}

bool CrackTracker::has_new() const
{
  return any_rank(comm_, std::ranges::any_of(before_, [](double damage) { return damage < 0.0; }));
}

std::vector<std::size_t> CrackTracker::new_ones() const
{
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < before_.size(); ++k)
    if (before_[k] < 0.0) places.push_back(k);
  return places;
}

void CrackTracker::note_new(std::span<const double> damage)
{
  auto next = damage.begin();
  for (double& before : before_)
    if (before < 0.0) before = *next++;
}

void CrackTracker::nothing_new(double time) { judge(time); }

CrackTracker::State CrackTracker::state() const
{
  return {time_, largest_speed_, {tree_.arrivals().begin(), tree_.arrivals().end()}, per_look_, before_};
}

void CrackTracker::resume(State state)
{
  time_ = state.time;
  largest_speed_ = state.largest_speed;
  before_ = std::move(state.damage);
  per_look_ = std::move(state.per_look);
  auto next = state.arrivals.begin();
  for (const int count : per_look_) {
    tree_.add({next, next + count});
    next += count;
  }
  tips_ = tree_.tips();
  judge(time_);
}

void CrackTracker::judge(double time)
{
  now_ = {0.0, 0.0, static_cast<int>(tips_.size())};
  for (const GrownTip& tip : tips_) {
    now_.grown += tip.own;
    now_.speed = std::max(now_.speed, tip_speed(tip, tree_.span(tip.start), time, time - time_));
  }
  largest_speed_ = std::max(largest_speed_, now_.speed);
  time_ = time;
}
} // namespace pdx::track
