#include "pdx/change/static_scene.hpp"

namespace pdx::change {
void StaticScene::begin_with(scene::Layout layout, scene::Dormant dormant)
{
  layout_ = std::move(layout);
  dormant_ = std::move(dormant);
}

void StaticScene::lay() { ground_ = std::make_unique<scene::Ground>(comm_, layout_.in(options_), nullptr, points_); }

void StaticScene::build()
{
  d_ = scene::discretise(ground_->mesh, ground_->options, ground_->plan, std::move(ground_->particles), assembled_,
                         points_.get(), &ground_->areas);
  u_ = d_->system.rows.vector();
}

double StaticScene::strain_energy(std::span<const double> u) const
{
  std::vector<double> local;
  d_->system.halo->fetch(u, d_->system.rows.dim, local);
  double energy = d_->energies(local).elastic();
  MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, comm_);
  return energy;
}

std::vector<double> StaticScene::internal_force(std::span<const double> u) const
{
  std::vector<double> local, force(u.size(), 0.0);
  d_->system.halo->fetch(u, d_->system.rows.dim, local);
  for (const auto& term : d_->system.terms) term->add_residual(local, force);
  return force;
}

StaticScene::Moment StaticScene::moment(std::span<const double> u, const adapt::LayoutChange& change)
{
  Moment now{scene::capture(standing()), d_->fracture ? d_->fracture->all() : pd::Broken{}, 0, {}};
  now.known = now.state.rows.size();
  now.state.moving.u.assign(u.begin(), u.end());
  if (!change.empty()) {
    std::vector<double> local;
    d_->system.halo->fetch(u, now.state.dim, local);
    const std::span<const double> fields[] = {local};
    scene::add_rows(now.state,
                    adapt::fill(view(), change, scene::patch_shapes(layout_.changed(change).in(options_)), fields));
    now.left = adapt::leaving(view(), change.uncover, fields);
  }
  scene::add_dormant(comm_, now.state, dormant_); // to the rows that are new, too
  return now;
}

void StaticScene::rebuild(const adapt::LayoutChange& change)
{
  d_.reset();
  if (change.empty()) {
    lay();
    ground_->lay_particles();
  } else {
    layout_ = layout_.changed(change);
    ground_->lay_again(layout_.in(ground_->options));
  }
  build();
}

std::vector<double> StaticScene::take(const Moment& moment, const adapt::LayoutChange& change)
{
  using From = scene::StateMove::From;
  const scene::StateMove move(moment.state, standing(), change.empty() ? From::same : From::changed);
  move.require_fit();
  move.break_bonds();
  left_over_ = move.dormant();
  if (d_->fracture) d_->fracture->resume(moment.broken);
  std::vector<double> u = move.rows(moment.state.moving.u, moment.state.dim);
  const std::span<double> fields[] = {u};
  if (!change.uncover.empty()) adapt::fit_sets(view(), moment.left, move.came_after(moment.known), fields);
  return u;
}
} // namespace pdx::change
