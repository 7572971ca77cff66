#include "pdx/change/time_scene.hpp"

#include "pdx/adapt/space_conversion.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/solve/explicit_driver.hpp"
#include "pdx/solve/implicit_driver.hpp"
#include "pdx/solve/kept_momentum.hpp"

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

void TimeScene::drive()
{
  const options::TimeOptions& time = options_.time;
  limits_ = scene_->limits();
  if (time.analysis == options::Analysis::implicit_dynamics)
    driver_ = std::make_unique<solve::ImplicitDriver>(scene_->system());
  else
    driver_ = std::make_unique<solve::ExplicitDriver>(
        scene_->system(),
        solve::ExplicitOptions{limits_.rigorous, time.safety, time.allow_unstable, time.subcycle, begun_});
  begun_ = true;
}

TimeScene::Moment TimeScene::moment(const adapt::LayoutChange& change,
                                    const std::optional<scene::CrackNotes>& cracks) const
{
  const scene::Standing standing = scene_->standing();
  couple::BondBreaker* breaker = standing.model->breaker;
  Moment now{scene::capture(standing, *driver_, cracks, change.empty() ? scene::Moves::all : scene::Moves::alone),
             breaker ? breaker->mine() : pd::Broken{},
             driver_->clock(),
             standing.model->rank_sums(),
             {},
             Vector<3>::Zero(),
             0,
             {}};
  now.known = now.state.rows.size();
  if (change.empty()) return now;
  now.momentum = driver_->moving().momentum(driver_->v());
  const field::Rows& rows = driver_->moving().system.rows;
  if (!any_rank(rows.comm, !driver_->moving().system.prescribed.components.empty())) // else it is not kept
    now.angular = solve::angular_momentum(driver_->moving(), driver_->local(), driver_->v());
  std::vector<double> v;
  driver_->moving().system.halo->fetch(driver_->v(), driver_->moving().system.rows.dim, v);
  const std::span<const double> fields[] = {driver_->local(), v};
  if (const adapt::SpaceView* space = scene_->space()) {
    scene::add_rows(now.state, adapt::fill(*space, change.cells, fields));
    return now;
  }
  const std::vector<couple::PatchShape> shapes = scene::patch_shapes(layout_.changed(change).in(options_));
  scene::add_rows(now.state, adapt::fill(scene_->view(), change, shapes, fields));
  now.left = adapt::leaving(scene_->view(), change.uncover, fields);
  return now;
}

void TimeScene::rebuild(const adapt::LayoutChange& change, std::optional<mesh::MeasuredCosts> costs)
{
  if (costs) costs_ = std::move(costs);
  driver_.reset();
  if (change.empty()) {
    scene_.reset();
    return build();
  }
  layout_ = layout_.changed(change);
  scene_->change(layout_);
  drive();
}

std::optional<scene::CrackNotes> TimeScene::take(Moment moment, const adapt::LayoutChange& change)
{
  using From = scene::StateMove::From;
  scene::add_dormant(comm_, moment.state, dormant_);
  const scene::StateMove move(moment.state, scene_->standing(), change.empty() ? From::same : From::changed);
  move.require_fit();
  move.break_bonds();
  move.hold_grips();
  dormant_ = move.dormant();
  if (change.empty())
    driver_->resume(moment.clock, move.moving());
  else {
    field::State moving = move.moving();
    const std::vector<double> is_new = move.came_after(moment.known);
    const std::span<double> fields[] = {moving.u, moving.v};
    if (!change.uncover.empty()) adapt::fit_sets(scene_->view(), moment.left, is_new, fields);
    solve::keep_momentum(driver_->moving(), is_new, moment.momentum, moving.v);
    solve::keep_angular_momentum(driver_->moving(), is_new, moment.angular, moving.u, moving.v);
    driver_->resume_changed(moment.clock, moving);
  }
  const scene::Model& model = *scene_->standing().model;
  if (model.breaker) model.breaker->resume(moment.broken);
  model.resume_sums(moment.sums);
  return move.cracks();
}
} // namespace pdx::change
