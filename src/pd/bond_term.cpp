#include "pdx/pd/bond_term.hpp"

#include "pdx/base/events.hpp"
#include "pdx/law/bond_force.hpp"

#include <algorithm>

namespace pdx::pd {
template <int Dim>
BondTerm<Dim>::BondTerm(std::vector<std::unique_ptr<LatticePart<Dim>>> parts, Kinematics kinematics, bool assembled)
    : parts_(std::move(parts)), kinematics_(kinematics), assembled_(assembled)
{
  for (const auto& part : parts_) {
    scratch_.push_back(part->window());
    part->forget_factors();
  }
}

template <int Dim>
BondTerm<Dim>::BondTerm(Parts parts, Kinematics kinematics)
    : parts_(std::move(parts.parts)), kinematics_(kinematics), assembled_(false)
{
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    Laid& laid = parts.laid[p];
    kept_.push_back(laid.strip != nullptr);
    scratch_.push_back(kept_[p] ? std::move(laid.scratch) : parts_[p]->window());
    strips_.push_back(std::move(laid.strip));
    parts_[p]->forget_factors();
  }
  left_out_ = kept_;
  if (std::ranges::none_of(kept_, [](bool is) { return is; })) strips_.clear();
}

template <int Dim> typename BondTerm<Dim>::Parts BondTerm<Dim>::give_up()
{
  Parts given{std::move(parts_), {}};
  for (std::size_t p = 0; p < given.parts.size(); ++p)
    given.laid.push_back({std::move(strips_[p]), std::move(scratch_[p])});
  return given;
}

template <int Dim> void BondTerm<Dim>::needed_rows(std::vector<PetscInt>& rows) const
{
  if (!assembled_) return;
  for (const auto& part : parts_) rows.insert(rows.end(), part->halo_rows().begin(), part->halo_rows().end());
}

template <int Dim> void BondTerm<Dim>::bind(const field::RowHalo& halo)
{
  halo_ = &halo;
  if (!assembled_) return;
  for (const auto& part : parts_) part->number_halo(halo);
}

template <int Dim> void BondTerm<Dim>::add_residual(std::span<const double> u, std::span<double> r) const
{
  static Event event("pd_force");
  Timed timed(event);
  for (const auto& strip : strips_) {
    strip->load(u);
    strip->add_force(r.data());
  }
  for (std::size_t p = 0; strips_.empty() && p < parts_.size(); ++p) {
    parts_[p]->load(u, scratch_[p]);
    add_force<Dim>(parts_[p]->view(scratch_[p]), parts_[p]->force_runs(), kinematics_, r.data());
  }
}

template <int Dim> void BondTerm<Dim>::swell(const field::FreeStrain& strain)
{
  PDX_ASSERT(strips_.empty());
  for (const auto& part : parts_) part->swell(strain);
}

template <int Dim> double BondTerm<Dim>::waited() const
{
  double seconds = 0.0;
  for (const auto& part : parts_) seconds += part->waited();
  return seconds;
}

template <int Dim> std::vector<double> BondTerm<Dim>::energy_density(std::span<const double> u) const
{
  std::vector<double> density(static_cast<std::size_t>(halo_->rows().owned()), 0.0);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    parts_[p]->load(u, scratch_[p]);
    add_energy_density<Dim>(parts_[p]->view(scratch_[p]), parts_[p]->force_runs(), kinematics_,
                            parts_[p]->stencil().volume(), density.data());
  }
  return density;
}

template <int Dim> double BondTerm<Dim>::energy(std::span<const double> u) const
{
  double total = 0.0;
  for (std::size_t p = 0; p < strips_.size(); ++p) {
    if (p < left_out_.size() && left_out_[p]) continue;
    strips_[p]->load(u);
    total += strips_[p]->energy();
  }
  if (!strips_.empty()) return total;
  const std::vector<double> density = energy_density(u);
  for (const auto& part : parts_)
    for (std::size_t k = 0; k < part->sites().size(); ++k)
      total += density[static_cast<std::size_t>(part->first_row()) + k] * part->stencil().volume();
  return total;
}

template <int Dim> void BondTerm<Dim>::linearise(std::span<const double> u)
{
  for (std::size_t p = 0; p < parts_.size() && kinematics_ == Kinematics::finite; ++p) {
    if (p == state_.size()) state_.push_back(parts_[p]->window());
    parts_[p]->load(u, state_[p]);
  }
}

template <int Dim> void BondTerm<Dim>::couplings(field::Couplings& couplings, bool whole) const
{
  if (!whole) return;
  for (const auto& part : parts_) {
    for (Index k = 0; k < static_cast<Index>(part->sites().size()); ++k)
      part->for_each_bond(k, [&](std::size_t, int, const Site<Dim>& other, double) {
        const auto row = static_cast<std::size_t>(part->first_row() + k);
        ++(part->row(other) < halo_->rows().owned() ? couplings.diagonal : couplings.off_diagonal)[row];
      });
  }
}

template <int Dim> void BondTerm<Dim>::add_diagonal(field::BlockAdder& adder) const
{
  constexpr std::size_t block = Dim * Dim;
  std::vector<double> diagonal(static_cast<std::size_t>(halo_->rows().owned()) * block, 0.0);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (kinematics_ == Kinematics::small)
      diagonal_blocks<Dim>(parts_[p]->view(scratch_[p]), parts_[p]->force_runs(), diagonal.data());
    else
      diagonal_blocks_finite<Dim>(parts_[p]->view(state_[p]), parts_[p]->force_runs(), diagonal.data());
  }
  for (const auto& part : parts_)
    for (std::size_t k = 0; k < part->sites().size(); ++k) {
      const Index row = part->first_row() + static_cast<Index>(k);
      adder.add({&row, 1}, {&row, 1}, {diagonal.data() + static_cast<std::size_t>(row) * block, block});
    }
}

template <int Dim>
void BondTerm<Dim>::add_whole(field::BlockAdder& adder, const LatticePart<Dim>& part, std::size_t number) const
{
  const bool finite = kinematics_ == Kinematics::finite;
  const auto& arms = part.stencil().half;
  std::vector<Index> columns;
  std::vector<Tensor<Dim>> blocks;
  std::vector<double> panel;
  for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k) {
    const Index row = part.first_row() + k;
    columns.assign(1, row);
    blocks.assign(1, Tensor<Dim>::Zero());
    part.for_each_bond(k, [&](std::size_t h, int sign, const Site<Dim>& other, double weight) {
      const Vector<Dim> xi = sign * arms[h].xi;
      const auto state = finite ? law::finite_state<Dim>(xi, arms[h].length, part.relative(state_[number], k, h, sign),
                                                         part.free_strain(k, h, sign))
                                : law::linear_state<Dim>(xi, arms[h].length, Vector<Dim>::Zero());
      const Tensor<Dim> stiffness = law::bond_stiffness<Dim>(weight * arms[h].kappa, arms[h].length, state);
      columns.push_back(part.row(other));
      blocks.push_back(-stiffness);
      blocks[0] += stiffness;
    });
    const std::size_t width = columns.size() * Dim;
    panel.resize(Dim * width);
    for (std::size_t c = 0; c < columns.size(); ++c)
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b)
          panel[static_cast<std::size_t>(a) * width + c * Dim + static_cast<std::size_t>(b)] = blocks[c](a, b);
    adder.add({&row, 1}, columns, panel);
  }
}

template <int Dim> void BondTerm<Dim>::add_jacobian(field::BlockAdder& adder, bool whole) const
{
  static Event event("pd_jacobian");
  Timed timed(event);
  if (!whole) return add_diagonal(adder);
  for (std::size_t p = 0; p < parts_.size(); ++p) add_whole(adder, *parts_[p], p);
}

template <int Dim> void BondTerm<Dim>::add_tangent_action(std::span<const double> x, std::span<double> y) const
{
  static Event event("pd_tangent");
  Timed timed(event);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    parts_[p]->load(x, scratch_[p]);
    if (kinematics_ == Kinematics::small)
      subtract_neighbours<Dim>(parts_[p]->view(scratch_[p]), parts_[p]->linear_runs(), y.data());
    else
      subtract_neighbours_finite<Dim>(parts_[p]->view(state_[p]), parts_[p]->view(scratch_[p]).u,
                                      parts_[p]->force_runs(), y.data());
  }
}

template <int Dim> void BondTerm<Dim>::add_mass(std::span<double> mass) const
{
  for (const auto& part : parts_)
    for (std::size_t k = 0; k < part->sites().size(); ++k)
      mass[static_cast<std::size_t>(part->first_row()) + k] +=
          part->stencil().volume() * part->density(static_cast<Index>(k));
}

template <int Dim> void BondTerm<Dim>::add_mass_in(field::RowRanges wanted, std::span<double> mass) const
{
  for (const auto& part : parts_)
    for (const auto& [first, end] : wanted) {
      const Index begin = part->first_row(), last = std::min(end, begin + static_cast<Index>(part->sites().size()));
      for (Index row = std::max(first, begin); row < last; ++row)
        mass[static_cast<std::size_t>(row)] += part->stencil().volume() * part->density(row - begin);
    }
}

template <int Dim> void BondTerm<Dim>::add_stiffness_bound(std::span<double> blocks) const
{
  constexpr std::size_t size = Dim * Dim;
  std::unique_ptr<double[]> diagonal; // by rows, of which those of new parts are looked at
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (is_kept(p)) continue;
    if (!diagonal) diagonal = std::make_unique_for_overwrite<double[]>(blocks.size());
    const std::size_t first = static_cast<std::size_t>(parts_[p]->first_row()) * size,
                      end = first + parts_[p]->sites().size() * size;
    std::fill(&diagonal[0] + first, &diagonal[0] + end, 0.0);
    diagonal_blocks<Dim>(parts_[p]->view(scratch_[p]), parts_[p]->force_runs(), diagonal.get());
    for (std::size_t k = first; k < end; ++k) blocks[k] += 2.0 * diagonal[k];
  }
}

template <int Dim> void BondTerm<Dim>::weak_rows(std::vector<Index>& rows) const
{
  for (const auto& part : parts_) part->weak_rows(rows);
}

template <int Dim> std::int64_t BondTerm<Dim>::cut(const crack::CrackSet& cracks)
{
  ++revision_;
  static Event event("pd_cut");
  Timed timed(event);
  std::int64_t count = 0;
  for (std::size_t p = 0; p < parts_.size(); ++p)
    if (!is_kept(p)) count += parts_[p]->cut(cracks);
  take_over_words(false);
  return count;
}

template <int Dim> void BondTerm<Dim>::protect(std::span<const geom::Box<2>> boxes)
{
  for (std::size_t p = 0; p < parts_.size(); ++p)
    if (!is_kept(p)) parts_[p]->protect(boxes);
  take_over_words(false);
}

template <int Dim> const typename BondTerm<Dim>::Windows& BondTerm<Dim>::load(std::span<const double> u) const
{
  for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p]->load(u, scratch_[p]);
  return scratch_;
}

template <int Dim> Broken BondTerm<Dim>::break_bonds(const Windows& loaded, std::span<const BreakRule> rules)
{
  Broken broken;
  ++revision_;
  for (std::size_t p = 0; p < parts_.size(); ++p) broken += parts_[p]->break_bonds(loaded[p], rules[p]);
  take_over_words(true);
  return broken;
}

template <int Dim>
void BondTerm<Dim>::overstretched(const Windows& loaded, std::span<const BreakRule> rules,
                                  std::vector<double>& ratios) const
{
  for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p]->overstretched(loaded[p], rules[p], ratios);
}

template <int Dim> void BondTerm<Dim>::save()
{
  for (const auto& part : parts_) part->save();
}

template <int Dim> void BondTerm<Dim>::restore()
{
  ++revision_;
  for (const auto& part : parts_) part->restore();
  take_over_words(true);
}

/// @param all not only of what is new here
template <int Dim> void BondTerm<Dim>::take_over_words(bool all)
{
  for (std::size_t p = 0; p < strips_.size(); ++p)
    if (strips_[p] && (all || !is_kept(p))) strips_[p]->take_over_words();
}

template <int Dim> void BondTerm<Dim>::step_explicitly(std::span<const BreakRule> rules, Processor processor)
{
  PDX_ASSERT(rules.empty() || rules.size() == parts_.size());
  strips_.resize(parts_.size());
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    if (!is_kept(p)) strips_[p] = std::make_unique<StripPart<Dim>>(*parts_[p], kinematics_, processor);
    if (!rules.empty()) strips_[p]->watch(rules[p].critical_stretch);
    strips_[p]->skip_below(at_rest_);
  }
}

template <int Dim> void BondTerm<Dim>::skip_below(double displacement)
{
  at_rest_ = displacement;
  for (const auto& strip : strips_) strip->skip_below(displacement);
}

template <int Dim> bool BondTerm<Dim>::overstretched_seen() const
{
  for (const auto& strip : strips_)
    if (strip->overstretched_seen()) return true;
  return false;
}

template <int Dim> Broken BondTerm<Dim>::break_overstretched(field::ForceLosses* losses)
{
  static Event event("pd_break");
  Timed timed(event);
  Broken broken;
  for (const auto& strip : strips_) broken += strip->break_bonds(losses);
  ++revision_;
  return broken;
}

template <int Dim> std::int64_t BondTerm<Dim>::tiles_computed() const
{
  std::int64_t count = 0;
  for (const auto& strip : strips_) count += strip->tiles_computed();
  return count;
}

template <int Dim> std::int64_t BondTerm<Dim>::tiles_skipped() const
{
  std::int64_t count = 0;
  for (const auto& strip : strips_) count += strip->tiles_skipped();
  return count;
}

template <int Dim> std::int64_t BondTerm<Dim>::bonds() const
{
  std::int64_t count = 0;
  for (const auto& part : parts_) count += part->bonds();
  return count;
}

template <int Dim> void BondTerm<Dim>::add_bonded_volume(std::span<BondedVolume> volumes) const
{
  for (const auto& part : parts_) part->add_bonded_volume(volumes);
}

template class BondTerm<2>;
template class BondTerm<3>;
} // namespace pdx::pd
