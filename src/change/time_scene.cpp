#include "pdx/change/time_scene.hpp"

#include "pdx/adapt/space_conversion.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/implicit_driver.hpp"
#include "pdx/solve/kept_momentum.hpp"

#include <algorithm>

namespace pdx::change {
void TimeScene::begin_with(scene::Layout layout, scene::Dormant dormant)
{
  layout_ = std::move(layout);
  dormant_ = std::move(dormant);
  begun_ = true;
}

void TimeScene::build()
{
  scene_ = make_(layout_, costs_ ? &*costs_ : nullptr);
  drive();
}

void TimeScene::drive(solve::MovingSystem::Values known)
{
  const options::TimeOptions& time = options_.time;
  limits_ = scene_->limits();
  if (time.analysis == options::Analysis::implicit_dynamics)
    driver_ = std::make_unique<solve::ImplicitDriver>(scene_->system());
  else
    driver_ = std::make_unique<solve::ExplicitDriver>(
        scene_->system(),
        solve::ExplicitOptions{limits_.rigorous, time.safety, time.allow_unstable, time.subcycle, begun_},
        std::move(known));
  begun_ = true;
}

namespace {
/// Local blocks [owned | halo] of owned ones.
std::span<const double> with_halo(const field::RowHalo& halo, std::span<const double> owned, std::vector<double>& room)
{
  int ranks = 1;
  MPI_Comm_size(halo.rows().comm, &ranks);
  if (ranks == 1) return owned;
  halo.fetch(owned, halo.rows().dim, room);
  return room;
}
} // namespace

TimeScene::Moment TimeScene::moment(const adapt::LayoutChange& change, std::optional<scene::CrackNotes> cracks) const
{
  const scene::Standing standing = scene_->standing();
  const field::System& system = driver_->moving().system;
  couple::BondBreaker* breaker = standing.model->breaker;
  Moment now;
  now.broken = breaker ? breaker->mine() : pd::Broken{};
  now.clock = driver_->clock();
  now.sums = standing.model->rank_sums();
  if (change.empty()) {
    now.state = scene::capture(standing, *driver_, cracks);
    return now;
  }
  const scene::Layout next = layout_.changed(change);
  if (scene_->hands_over(next)) {
    now.state = scene::capture_around(standing);
    now.passing.cracks = std::move(cracks);
    now.passing.first_particle = system.rows.first_particle();
  } else
    now.state = scene::capture(standing, *driver_, cracks, scene::Moves::alone);
  now.momentum = driver_->moving().momentum(driver_->v());
  if (!any_rank(system.rows.comm, !system.prescribed.components.empty())) // else it is not kept
    now.angular = solve::angular_momentum(driver_->moving(), driver_->local(), driver_->v());
  std::vector<double> room;
  const std::span<const double> fields[] = {driver_->local(), with_halo(*system.halo, driver_->v(), room)};
  if (const adapt::SpaceView* space = scene_->space()) {
    now.fresh = adapt::fill(*space, change.cells, fields);
    return now;
  }
  now.fresh = adapt::fill(scene_->view(), change, scene::patch_shapes(next.in(options_)), fields);
  now.left = adapt::leaving(scene_->view(), change.uncover, fields);
  return now;
}

void TimeScene::rebuild(const adapt::LayoutChange& change, std::optional<mesh::MeasuredCosts> costs, Moment& moment)
{
  if (costs) costs_ = std::move(costs);
  if (change.empty()) {
    driver_.reset();
    scene_.reset();
    return build();
  }
  solve::MovingSystem::Values& values = moment.passing.values;
  values = driver_->give_up();
  driver_.reset();
  layout_ = layout_.changed(change);
  moment.handed = scene_->change(layout_);
  if (moment.handed)
    scene::add_leaving(moment.state, scene_->standing(), *moment.handed, moment.passing);
  else
    values = {};
  moment.known = moment.state.rows.size();
  scene::add_rows(moment.state, moment.fresh);
  drive(std::move(values));
  driver_->count_only(scene_->changing_rows());
}

std::optional<scene::CrackNotes> TimeScene::take(Moment moment, const adapt::LayoutChange& change)
{
  using From = scene::StateMove::From;
  scene::add_dormant(comm_, moment.state, dormant_);
  const scene::StateMove move(moment.state, scene_->standing(), change.empty() ? From::same : From::changed,
                              moment.handed ? &moment.handed->rows : nullptr);
  move.require_fit();
  move.break_bonds();
  move.hold_grips();
  dormant_ = move.dormant();
  if (change.empty())
    driver_->resume(moment.clock, move.moving());
  else
    begin_changed(moment, move, change);
  const scene::Model& model = *scene_->standing().model;
  if (model.breaker) model.breaker->resume(moment.broken);
  model.resume_sums(moment.sums);
  if (!moment.handed) return move.cracks();
  if (moment.passing.cracks) move.place_damage(moment.passing.cracks->tracker.damage);
  return std::move(moment.passing.cracks);
}

/// Rows that did not stay begin, and those that are new take what is missing of the momentum.
void TimeScene::begin_changed(const Moment& moment, const scene::StateMove& move, const adapt::LayoutChange& change)
{
  const auto [u, v] = driver_->values();
  const int dim = moment.state.dim;
  for (const auto& [from, to] : {std::pair{&moment.state.moving.u, u}, std::pair{&moment.state.moving.v, v}}) {
    const std::vector<double> values = move.rows(*from, dim);
    auto next = values.begin();
    for (const Index row : move.rows()) {
      std::copy_n(next, dim, to.begin() + std::ptrdiff_t{row} * dim);
      next += dim;
    }
  }
  const std::vector<Index> is_new = move.came_after(moment.known);
  const std::span<double> fields[] = {u, v};
  if (!change.uncover.empty()) adapt::fit_sets(scene_->view(), moment.left, is_new, fields);
  solve::keep_momentum(driver_->moving(), is_new, moment.momentum, v);
  solve::keep_angular_momentum(driver_->moving(), is_new, moment.angular, u, v);
  driver_->resume_changed(moment.clock);
}
} // namespace pdx::change
