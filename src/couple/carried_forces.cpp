#include "pdx/couple/carried_family.hpp"
#include "pdx/couple/carried_runs.hpp"

#include <algorithm>
#include <limits>

// How carried bonds are laid out for their forces: in runs, in lanes, or one by one.
namespace pdx::couple {
template <int Dim> void CarriedFamily<Dim>::bind(const field::RowHalo& halo)
{
  points_.bind(halo);
  laid_out_ = false;
  bound_ = true;
  std::vector<bool> uses(static_cast<std::size_t>(halo.size()), false);
  for (const Index row : points_.all_rows()) uses[static_cast<std::size_t>(row)] = true;
  used_.clear();
  for (std::size_t row = 0; row < uses.size(); ++row)
    if (uses[row]) used_.push_back(static_cast<Index>(row));
}

template <int Dim> void CarriedFamily<Dim>::add_mass(std::span<double> mass) const
{
  if (!hands_) return;
  for (const CarriedBond<Dim>& bond : bonds_) {
    if (bond.handed == 0.0) continue;
    for (const auto& [point, sign] : {std::pair{bond.a, -1.0}, std::pair{bond.b, 1.0}})
      for (std::size_t k = 0; k < points_.rows(point).size(); ++k)
        if (const Index row = points_.rows(point)[k]; row < rows_.owned())
          mass[static_cast<std::size_t>(row)] += sign * points_.tied_weights(point)[k] * bond.handed;
  }
}

template <int Dim> void CarriedFamily<Dim>::step_explicitly()
{
  if (runs_) return;
  std::vector<RunBond<Dim>> along_sides;
  along_sides.reserve(bonds_.size());
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    const CarriedBond<Dim>& bond = bonds_[number];
    if (bond.leaves.side < 0 || !starts_at_row(bond)) continue;
    along_sides.push_back(
        {number, points_.rows(bond.a)[0], bond.b, bond.patch, bond.no_fail, bond.stretch, bond.xi, bond.leaves});
  }
  runs_ = std::make_unique<CarriedRuns<Dim>>(points_, along_sides, rows_.owned());
  laid_out_ = false;
}

/// Most bonds go from a particle to a point of an edge or an element, and act where they stretch.
template <int Dim> bool CarriedFamily<Dim>::starts_at_row(const CarriedBond<Dim>& bond) const
{
  return bond.force_a == bond.a && bond.force_b == bond.b && points_.rows(bond.a).size() == 1 &&
         points_.weights(bond.a)[0] == 1.0;
}

template <int Dim> void CarriedFamily<Dim>::swell(const field::FreeStrain& strain)
{
  PDX_ASSERT(!runs_);
  const bool first = free_.empty();
  free_.clear();
  free_.reserve(bonds_.size());
  for (const CarriedBond<Dim>& bond : bonds_)
    free_.push_back(0.5 * (strain(bond.from) + strain(bond.from + bond.xi.template head<2>())));
  if (first) laid_out_ = false;
}

template <int Dim> void CarriedFamily<Dim>::fill_lanes() const
{
  laid_out_ = true;
  std::vector<bool> in_run(bonds_.size(), false);
  if (runs_)
    for (const std::size_t number : runs_->numbers()) in_run[number] = true;
  lanes_ = {CarriedLanes<Dim>(1), CarriedLanes<Dim>(2), CarriedLanes<Dim>(4)};
  others_.clear();
  lanes_revision_ = -1;
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    if (in_run[number]) continue;
    const CarriedBond<Dim>& bond = bonds_[number];
    const std::span<const Index> hosts = points_.rows(bond.b);
    const auto fits = [&](const CarriedLanes<Dim>& lanes) {
      return hosts.size() <= static_cast<std::size_t>(lanes.width());
    };
    const auto of = free_.empty() && starts_at_row(bond) ? std::ranges::find_if(lanes_, fits) : lanes_.end();
    if (of == lanes_.end())
      others_.push_back(number);
    else
      of->add(number, {points_.rows(bond.a)[0], hosts, points_.weights(bond.b), bond.xi});
  }
}

/// Stiffness of what is intact, and the limits of those who watch, a little early: whether bonds break is judged one by
/// one.
template <int Dim> void CarriedFamily<Dim>::refresh_lanes() const
{
  if (!laid_out_) fill_lanes();
  if (lanes_revision_ == revision_) return;
  lanes_revision_ = revision_;
  constexpr double kEarly = 1.0 - 1e-12;
  if (runs_) refresh_runs();
  for (CarriedLanes<Dim>& lanes : lanes_)
    for (std::size_t k = 0; k < lanes.numbers().size(); ++k) {
      const std::size_t number = lanes.numbers()[k];
      const CarriedBond<Dim>& bond = bonds_[number];
      const bool watched = !limits_.empty() && !bond.no_fail && !gone_[number];
      lanes.set(k, gone_[number] ? 0.0 : bond.kappa,
                watched ? kEarly * bond.stretch * limits_[static_cast<std::size_t>(bond.patch)]
                        : std::numeric_limits<double>::infinity());
    }
}

/// Earlier still: points in runs are the same but for the rounding of weights.
template <int Dim> void CarriedFamily<Dim>::refresh_runs() const
{
  constexpr double kEarly = 1.0 - 1e-9;
  runs_->set_stiffness(
      [this](std::size_t number) { return gone_[number] ? 0.0 : bonds_[number].kappa / rest_[number].length; });
  runs_->set_limits([this](Index patch, double stretch) {
    if (limits_.empty()) return std::numeric_limits<double>::infinity();
    const double s = limits_[static_cast<std::size_t>(patch)] * stretch;
    return kEarly * (kinematics_ == law::Kinematics::finite ? s * (2.0 + s) : s);
  });
}

template <int Dim> void CarriedFamily<Dim>::add_residual(std::span<const double> u, std::span<double> r) const
{
  refresh_lanes();
  const bool finite = kinematics_ == law::Kinematics::finite;
  overstretched_seen_ = runs_ && runs_->add_forces(processor_, finite, u, r);
  for (const CarriedLanes<Dim>& lanes : lanes_)
    if (lanes.add_forces(processor_, finite, u, rows_.owned(), r)) overstretched_seen_ = true;
  for (const std::size_t number : others_) {
    if (gone_[number]) continue;
    const CarriedBond<Dim>& bond = bonds_[number];
    const Vector<Dim> eta = points_.displacement(bond.b, u) - points_.displacement(bond.a, u);
    const law::BondState<Dim> state = state_of(number, eta, kinematics_);
    if (!limits_.empty() && !bond.no_fail &&
        state.stretch > limits_[static_cast<std::size_t>(bond.patch)] * bond.stretch)
      overstretched_seen_ = true;
    const Vector<Dim> force = bond.kappa * state.stretch * state.direction;
    points_.add_force(bond.force_a, -force, rows_.owned(), r);
    points_.add_force(bond.force_b, force, rows_.owned(), r);
  }
}

template void CarriedFamily<2>::bind(const field::RowHalo&);
template void CarriedFamily<3>::bind(const field::RowHalo&);
template void CarriedFamily<2>::swell(const field::FreeStrain&);
template void CarriedFamily<3>::swell(const field::FreeStrain&);
template void CarriedFamily<2>::step_explicitly();
template void CarriedFamily<3>::step_explicitly();
template void CarriedFamily<2>::add_residual(std::span<const double>, std::span<double>) const;
template void CarriedFamily<3>::add_residual(std::span<const double>, std::span<double>) const;
} // namespace pdx::couple
