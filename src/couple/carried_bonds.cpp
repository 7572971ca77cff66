#include "pdx/couple/carried_bonds.hpp"

#include "pdx/base/events.hpp"
#include "pdx/couple/carried_runs.hpp"

#include <algorithm>

namespace pdx::couple {
template <int Dim>
CarriedBonds<Dim>::CarriedBonds(const field::Rows& rows, CarriedPoints<Dim> points, std::vector<CarriedBond<Dim>> bonds,
                                law::Kinematics kinematics, bool symmetric)
    : rows_(rows), kept_(1, false), kinematics_(kinematics), symmetric_(symmetric)
{
  families_.push_back(std::make_unique<Family>(rows, std::move(points), std::move(bonds), kinematics, symmetric));
}

template <int Dim>
CarriedBonds<Dim>::CarriedBonds(const field::Rows& rows, Families families,
                                std::shared_ptr<const field::RowShift> shift, law::Kinematics kinematics,
                                bool symmetric)
    : rows_(rows), families_(std::move(families)), shift_(std::move(shift)), kinematics_(kinematics),
      symmetric_(symmetric)
{
  for (const auto& family : families_) kept_.push_back(family->bound());
  left_out_ = kept_;
}

template <int Dim> void CarriedBonds<Dim>::needed_rows(std::vector<PetscInt>& rows) const
{
  for (std::size_t f = 0; f < families_.size(); ++f)
    if (!kept_[f])
      families_[f]->needed_rows(rows);
    else
      for (const Index row : families_[f]->used_rows())
        if (row >= shift_->before().rows().owned()) rows.push_back((*shift_)(shift_->before().global(row)));
}

template <int Dim> void CarriedBonds<Dim>::bind(const field::RowHalo& halo)
{
  std::vector<Index> theirs, now;
  for (std::size_t f = 0; f < families_.size(); ++f)
    if (!kept_[f])
      families_[f]->bind(halo);
    else
      for (const Index row : families_[f]->used_rows())
        if (row >= shift_->before().rows().owned()) theirs.push_back(row);
  if (!shift_) return;
  const auto stays = [&](Index row) { return halo.local((*shift_)(shift_->before().global(row))) == row; };
  bool same = true;
  for (std::size_t f = 0; f < families_.size(); ++f)
    same = same && (!kept_[f] || std::ranges::all_of(families_[f]->used_rows(), stays));
  if (!same) now = shift_->local_rows(halo, theirs);
  for (std::size_t f = 0; f < families_.size(); ++f)
    if (kept_[f]) families_[f]->move_rows(rows_, now, static_cast<Index>(f));
  shift_.reset();
}

template <int Dim> void CarriedBonds<Dim>::step_explicitly()
{
  for (const auto& family : families_) family->step_explicitly();
}

template <int Dim> void CarriedBonds<Dim>::swell(const field::FreeStrain& strain)
{
  for (const auto& family : families_) family->swell(strain);
}

template <int Dim> void CarriedBonds<Dim>::add_residual(std::span<const double> u, std::span<double> r) const
{
  static Event event("couple_force");
  const Timed timed(event);
  for (const auto& family : families_) family->add_residual(u, r);
}

template <int Dim> double CarriedBonds<Dim>::energy(std::span<const double> u) const
{
  double total = 0.0;
  for (std::size_t f = 0; f < families_.size(); ++f)
    if (f >= left_out_.size() || !left_out_[f]) total += families_[f]->energy(u);
  return total;
}

template <int Dim> void CarriedBonds<Dim>::linearise(std::span<const double> u)
{
  for (const auto& family : families_) family->linearise(u);
}

template <int Dim> void CarriedBonds<Dim>::couplings(field::Couplings& couplings, bool whole) const
{
  for (const auto& family : families_) family->couplings(couplings, whole);
}

template <int Dim> void CarriedBonds<Dim>::add_jacobian(field::BlockAdder& adder, bool whole) const
{
  static Event event("couple_jacobian");
  const Timed timed(event);
  for (const auto& family : families_) family->add_jacobian(adder, whole);
}

template <int Dim> void CarriedBonds<Dim>::add_stiffness_bound(std::span<double> blocks) const
{
  for (const auto& family : families_) family->add_stiffness_bound(blocks);
}

template <int Dim> void CarriedBonds<Dim>::add_mass(std::span<double> mass) const
{
  for (const auto& family : families_) family->add_mass(mass);
}

template <int Dim>
void CarriedBonds<Dim>::add_energy_density(std::span<const double> u, std::span<double> density) const
{
  for (const auto& family : families_) family->add_energy_density(u, density);
}

template <int Dim>
pd::Broken CarriedBonds<Dim>::break_bonds(std::span<const double> u, std::span<const pd::BreakRule> rules,
                                          field::ForceLosses* losses)
{
  pd::Broken broken;
  for (const auto& family : families_) broken += family->break_bonds(u, rules, losses);
  return broken;
}

template <int Dim> void CarriedBonds<Dim>::watch(std::span<const pd::BreakRule> rules)
{
  for (const auto& family : families_) family->watch(rules);
}

template <int Dim> bool CarriedBonds<Dim>::overstretched_seen() const
{
  return std::ranges::any_of(families_, [](const auto& family) { return family->overstretched_seen(); });
}

template <int Dim>
void CarriedBonds<Dim>::overstretched(std::span<const double> u, std::span<const pd::BreakRule> rules,
                                      std::vector<double>& ratios) const
{
  for (const auto& family : families_) family->overstretched(u, rules, ratios);
}

template <int Dim> std::vector<std::uint64_t> CarriedBonds<Dim>::broken() const
{
  std::vector<std::uint64_t> keys;
  for (const auto& family : families_) {
    const std::vector<std::uint64_t> more = family->broken();
    keys.insert(keys.end(), more.begin(), more.end());
  }
  return keys;
}

template <int Dim> void CarriedBonds<Dim>::set_broken(std::span<const std::uint64_t> keys)
{
  for (std::size_t f = 0; f < families_.size(); ++f)
    if (!kept_[f]) families_[f]->set_broken(keys);
}

template <int Dim> void CarriedBonds<Dim>::save()
{
  for (const auto& family : families_) family->save();
}

template <int Dim> void CarriedBonds<Dim>::restore()
{
  for (const auto& family : families_) family->restore();
}

template <int Dim> std::int64_t CarriedBonds<Dim>::revision() const
{
  std::int64_t all = 0; // each of them only grows
  for (const auto& family : families_) all += family->revision();
  return all;
}

template <int Dim> void CarriedBonds<Dim>::add_bonded_volume(std::span<pd::BondedVolume> volumes) const
{
  for (const auto& family : families_) family->add_bonded_volume(volumes);
}

template <int Dim> void CarriedBonds<Dim>::add_thinned(std::vector<Index>& rows) const
{
  for (const auto& family : families_) family->add_thinned(rows);
}

template <int Dim> void CarriedBonds<Dim>::add_bonded_volume(Index row, pd::BondedVolume& volume) const
{
  for (const auto& family : families_) family->add_bonded_volume(row, volume);
}

template <int Dim> void CarriedBonds<Dim>::add_joints(std::vector<std::array<Index, 2>>& pairs) const
{
  for (const auto& family : families_) family->add_joints(pairs);
}

template <int Dim> std::size_t CarriedBonds<Dim>::size() const
{
  std::size_t all = 0;
  for (const auto& family : families_) all += family->size();
  return all;
}

template <int Dim> std::int64_t CarriedBonds<Dim>::bonds() const
{
  std::int64_t all = 0;
  for (const auto& family : families_) all += family->bonds();
  return all;
}

template class CarriedBonds<2>;
template class CarriedBonds<3>;
} // namespace pdx::couple
