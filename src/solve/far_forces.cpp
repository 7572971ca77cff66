#include "pdx/solve/far_forces.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/solve/stable_step.hpp"

#include <algorithm>

namespace pdx::solve {
FarForces::FarForces(MovingSystem& moving)
    : moving_(moving), a_(moving.owned(), 0.0), held_(moving.system.prescribed.components.size(), 0.0),
      held_before_(held_), u_before_(held_)
{
  const field::System& system = moving_.system;
  const field::Rows& rows = system.rows;
  for (const auto& term : system.terms) parted_.push_back(dynamic_cast<field::Parted*>(term.get()));
  const std::vector<std::uint8_t> touched = marked();
  std::vector<std::uint8_t> near = touched;
  for (field::Parted* parted : parted_)
    if (parted) parted->part(touched, near);
  near.resize(static_cast<std::size_t>(rows.owned()));
  for (Index row = 0; row < rows.owned(); ++row) (near[static_cast<std::size_t>(row)] ? near_ : far_).push_back(row);
  any_ = any_rank(rows.comm, !far_.empty());
  for (std::uint8_t& is : near) is = !is;
  take_loads(near);
  moving_.leave_far(std::move(near), {parted_.begin(), parted_.end()});
}

/// Local rows that Terms couple with anything, but for those that part themselves.
std::vector<std::uint8_t> FarForces::marked() const
{
  const field::System& system = moving_.system;
  std::vector<double> mine(static_cast<std::size_t>(system.rows.owned()), 0.0), all;
  for (std::size_t k = 0; k < parted_.size(); ++k) {
    if (parted_[k]) continue;
    field::Couplings couplings(*system.halo);
    system.terms[k]->couplings(couplings, true);
    for (std::size_t row = 0; row < mine.size(); ++row)
      if (couplings.diagonal[row] > 1 || couplings.off_diagonal[row] > 0) mine[row] = 1.0;
  }
  std::fill(mine.begin() + system.rows.first_particle(), mine.end(), 1.0);
  system.halo->fetch(mine, 1, all);
  return {all.begin(), all.end()};
}

void FarForces::take_loads(const std::vector<std::uint8_t>& far)
{
  const field::System& system = moving_.system;
  for (const field::Drive& drive : system.drives) {
    if (drive.kind != field::Drive::Kind::force) continue;
    Load load{&drive, {}, {}, {}, {}};
    for (std::size_t k = 0; k < drive.components.size(); ++k) {
      const auto component = static_cast<std::size_t>(drive.components[k]);
      if (far[component / static_cast<std::size_t>(system.rows.dim)] && !system.held[component])
        load.entries.push_back(k);
    }
    load.force.assign(load.entries.size(), 0.0);
    load.force_before = load.u_before = load.force;
    loads_.push_back(std::move(load));
  }
}

double FarForces::limit() const { return far_stable_step(moving_.system).limit; }

void FarForces::evaluate(double time)
{
  const field::System& system = moving_.system;
  std::ranges::fill(a_, 0.0);
  for (std::size_t k = 0; k < parted_.size(); ++k) {
    if (!parted_[k]) continue;
    const double begin = MPI_Wtime();
    parted_[k]->add_far(moving_.u, a_);
    moving_.add_busy(k, MPI_Wtime() - begin);
  }
  const auto& held = system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) held_[k] = a_[static_cast<std::size_t>(held[k])];
  moving_.set_far_held(held_);
  for (Load& load : loads_) {
    const double now = load.drive->history.value(time);
    for (std::size_t k = 0; k < load.entries.size(); ++k) {
      const std::size_t entry = load.entries[k];
      load.force[k] = now * load.drive->values[entry];
      a_[static_cast<std::size_t>(load.drive->components[entry])] -= load.force[k];
    }
  }
  moving_.accelerate(a_);
}

void FarForces::begin()
{
  for (Load& load : loads_) {
    load.force_before = load.force;
    for (std::size_t k = 0; k < load.entries.size(); ++k)
      load.u_before[k] = moving_.u[static_cast<std::size_t>(load.drive->components[load.entries[k]])];
  }
  held_before_ = held_;
  const auto& held = moving_.system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k) u_before_[k] = moving_.u[static_cast<std::size_t>(held[k])];
}

void FarForces::book()
{
  double work = 0.0;
  for (const Load& load : loads_)
    for (std::size_t k = 0; k < load.entries.size(); ++k)
      work += 0.5 * (load.force_before[k] + load.force[k]) *
              (moving_.u[static_cast<std::size_t>(load.drive->components[load.entries[k]])] - load.u_before[k]);
  const auto& held = moving_.system.prescribed.components;
  for (std::size_t k = 0; k < held.size(); ++k)
    work += 0.5 * (held_before_[k] + held_[k]) * (moving_.u[static_cast<std::size_t>(held[k])] - u_before_[k]);
  moving_.set_work(moving_.work() + work);
  begin();
}
} // namespace pdx::solve
