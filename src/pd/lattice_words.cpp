#include "pdx/law/bond_force.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>

// What changes in a LatticePart: bond words, and the runs that follow from them.
namespace pdx::pd {
namespace {
constexpr double kWeak = 1e-2; // a particle with less than this share of a full family's stiffness may be loose

/// The runs of particles alike: whole where `traits & mask` is `wanted`.
void split_runs(std::span<const Run> segments, const std::uint8_t* traits, std::uint8_t mask, std::uint8_t wanted,
                std::vector<Run>& runs)
{
  runs.clear();
  for (const Run& segment : segments) {
    const std::uint8_t* of = traits + segment.at;
    for (Index k = 0; k < segment.length;) {
      const bool whole = (of[k] & mask) == wanted;
      Index end = k + 1;
      while (end < segment.length && ((of[end] & mask) == wanted) == whole) ++end;
      runs.push_back({segment.at + k, segment.row + k, end - k, whole ? RunKind::whole : RunKind::partial});
      k = end;
    }
  }
}
} // namespace

/// Looks at every bond near a border; afterwards only losses change traits.
template <int Dim> void LatticePart<Dim>::find_traits()
{
  const auto size = static_cast<std::size_t>(window_size_);
  traits_.assign(size, 0);
  std::array<std::uint64_t, 2> all{0, 0};
  for (std::size_t h = 0; h < arms_.size(); ++h) all[h / 64] |= std::uint64_t{1} << (h % 64);
  std::vector<std::uint8_t> bulk(size, 1); // all bonds that start there, without factors
  for (std::size_t p = 0; p < planes(); ++p)
    for (std::size_t i = 0; i < size; ++i) bulk[i] &= words_[p][i] == all[p];
  for (std::size_t i = 0; i < classes_.size(); ++i) bulk[i] &= classes_[i] == 0;
  bulk = surrounded(std::move(bulk));
  for_each_own([&](std::size_t k, const Site<Dim>& site) {
    const std::ptrdiff_t i = at(site);
    const Index row = first_row_ + static_cast<Index>(k);
    traits_[static_cast<std::size_t>(i)] = bulk[static_cast<std::size_t>(i)] ? kOwned | kPlain | kComplete : traits(i);
    const bool on = !segments_.empty() && segments_.back().at + segments_.back().length == i;
    if (on)
      ++segments_.back().length;
    else
      segments_.push_back({i, row, 1, RunKind::whole});
  });
}

/// Of an owned particle, as its bonds say.
template <int Dim> std::uint8_t LatticePart<Dim>::traits(std::ptrdiff_t i) const
{
  std::uint8_t found = kOwned | kPlain | kComplete;
  for (std::size_t h = 0; h < arms_.size(); ++h)
    for (const Index sign : {1, -1}) {
      const std::ptrdiff_t j = i + sign * arms_[h].jump;
      const bool there = has_bond(sign > 0 ? i : j, h);
      if (!there) found &= static_cast<std::uint8_t>(~kComplete);
      // The linear kernel takes bonds that never were for bonds to u = 0: not where a particle is.
      if (!there && !where_.active.is_box() && where_.active.has(site_at(j)))
        found &= static_cast<std::uint8_t>(~kPlain);
      if (there && surface_factor(sign > 0 ? i : j, h) != 1.0) found &= static_cast<std::uint8_t>(~kPlain);
    }
  return found;
}

template <int Dim> void LatticePart<Dim>::make_runs() const
{
  runs_stale_ = false;
  split_runs(segments_, traits_.data(), kPlain | kComplete | kLost, kPlain | kComplete, force_runs_);
  split_runs(segments_, traits_.data(), kPlain | kLost, kPlain, linear_runs_);
}

/// Calls visit(window index of the lower end, half arm) for the bonds that are in `before` only.
template <int Dim>
template <class Visit>
void LatticePart<Dim>::for_each_loss(const Words& before, const Words& after, Visit&& visit)
{
  for (std::size_t p = 0; p < 2; ++p)
    for (std::size_t i = 0; i < before[p].size(); ++i)
      for (std::uint64_t lost = before[p][i] & ~after[p][i]; lost; lost &= lost - 1)
        visit(static_cast<std::ptrdiff_t>(i), 64 * p + static_cast<std::size_t>(std::countr_zero(lost)));
}

template <int Dim> void LatticePart<Dim>::note_loss(std::ptrdiff_t i, std::size_t h)
{
  saved_.current = false;
  for (const std::ptrdiff_t end : {i, i + arms_[h].jump})
    if (end < window_size_) {
      traits_[static_cast<std::size_t>(end)] |= kLost;
      if (!now_volume_.empty()) thinned_.push_back(end);
    }
  if (thinned_.size() > sites_.size()) forget_volume();
  runs_stale_ = true;
}

/// Brings traits and runs up to date after `words_` was `other_words_`.
template <int Dim> void LatticePart<Dim>::note_losses()
{
  for_each_loss(other_words_, words_, [&](std::ptrdiff_t i, std::size_t h) { note_loss(i, h); });
}

template <int Dim> void LatticePart<Dim>::protect(std::span<const geom::Box<2>> boxes)
{
  no_fail_.clear();
  if (boxes.empty()) return;
  no_fail_.assign(static_cast<std::size_t>(window_size_), 0);
  Site<Dim> site = lower_;
  for (std::ptrdiff_t i = 0; i + kWindowPadding < window_size_; ++i) {
    const Vector<2> x = where_.lattice.point(site).template head<2>();
    no_fail_[static_cast<std::size_t>(i)] =
        std::any_of(boxes.begin(), boxes.end(), [&](const geom::Box<2>& box) { return box.contains(x); });
    for (std::size_t d = 0; d < Dim; ++d) {
      if (++site[d] < lower_[d] + extent_[d]) break;
      site[d] = lower_[d];
    }
  }
}

template <int Dim> std::int64_t LatticePart<Dim>::cut(const crack::CrackSet& cracks)
{
  remember_volume();
  other_words_ = words_;
  const std::int64_t count =
      cut_bonds<Dim>(cracks, WindowSites<Dim>{where_.lattice, lower_, extent_}, stencil_, segments_, writable(words_));
  note_losses();
  start_volume_ = bonded_volume_now();
  return count;
}

template <int Dim> Broken LatticePart<Dim>::break_bonds(const Window& loaded, BreakRule rule)
{
  remember_volume();
  rule = completed(rule);
  other_words_ = words_;
  Broken broken;
  broken.bonds = pd::break_bonds<Dim>(view(loaded), segments_, rule, writable(words_));
  for_each_loss(other_words_, words_, [&](std::ptrdiff_t i, std::size_t h) {
    if (traits_[static_cast<std::size_t>(i)] & kOwned)
      broken.energy += energy_of(i, h, stretch(loaded, i, h, rule.kinematics));
  });
  note_losses();
  return broken;
}

template <int Dim> Broken LatticePart<Dim>::lose(LostBonds lost, Kinematics kinematics, field::ForceLosses* losses)
{
  Broken broken;
  if (!lost.empty()) remember_volume();
  for (const LostBond<Dim>& bond : lost) {
    words_[bond.arm / 64][static_cast<std::size_t>(bond.at)] &= ~(std::uint64_t{1} << bond.arm % 64);
    note_loss(bond.at, bond.arm);
    if (losses) note_force(bond, kinematics, *losses);
    if (!(traits_[static_cast<std::size_t>(bond.at)] & kOwned)) continue;
    ++broken.bonds;
    broken.energy += energy_of(bond.at, bond.arm, stretch(bond, kinematics));
  }
  return broken;
}

/// What a bond pulled its owned ends with, as internal force: -kappa s n on the lower end, the opposite on the other.
template <int Dim>
void LatticePart<Dim>::note_force(const LostBond<Dim>& bond, Kinematics kinematics, field::ForceLosses& losses) const
{
  const Arm<Dim>& arm = stencil_.half[bond.arm];
  const double free = free_strain(bond.at, bond.arm);
  const law::BondState<Dim> state = kinematics == Kinematics::finite
                                        ? law::finite_state<Dim>(arm.xi, arm.length, bond.eta, free)
                                        : law::linear_state<Dim>(arm.xi, arm.length, bond.eta, free);
  const std::ptrdiff_t end = bond.at + arms_[bond.arm].jump;
  const Vector<Dim> pull = surface_factor(bond.at, bond.arm) * arm.kappa * state.stretch * state.direction;
  for (const auto& [site, sign] : {std::pair{bond.at, -1.0}, std::pair{end, 1.0}}) {
    if (!(traits_[static_cast<std::size_t>(site)] & kOwned)) continue;
    const Index row = local_rows_[static_cast<std::size_t>(site)];
    for (int d = 0; d < Dim; ++d) losses.push_back({row * Dim + d, sign * pull[d]});
  }
}

template <int Dim>
void LatticePart<Dim>::overstretched(const Window& loaded, BreakRule rule, std::vector<double>& ratios) const
{
  rule = completed(rule);
  other_words_ = words_;
  pd::break_bonds<Dim>(view(loaded), segments_, rule, writable(other_words_));
  for_each_loss(words_, other_words_, [&](std::ptrdiff_t i, std::size_t h) {
    if (traits_[static_cast<std::size_t>(i)] & kOwned)
      ratios.push_back(stretch(loaded, i, h, rule.kinematics) / (rule.critical_stretch * stretch_factor(i, h)));
  });
}

template <int Dim>
double LatticePart<Dim>::stretch(const Window& loaded, std::ptrdiff_t i, std::size_t h, Kinematics kinematics) const
{
  LostBond<Dim> bond{i, static_cast<std::uint32_t>(h), {}};
  for (std::size_t d = 0; d < Dim; ++d)
    bond.eta[static_cast<Eigen::Index>(d)] =
        loaded[d][static_cast<std::size_t>(i + arms_[h].jump)] - loaded[d][static_cast<std::size_t>(i)];
  return stretch(bond, kinematics);
}

template <int Dim> double LatticePart<Dim>::stretch(const LostBond<Dim>& bond, Kinematics kinematics) const
{
  const Vector<Dim> xi = Eigen::Map<const Vector<Dim>>(arms_[bond.arm].xi.data());
  const double l = arms_[bond.arm].length, free = free_strain(bond.at, bond.arm);
  return kinematics == Kinematics::finite ? law::finite_state<Dim>(xi, l, bond.eta, free).stretch
                                          : law::linear_state<Dim>(xi, l, bond.eta, free).stretch;
}

/// Strain energy of a bond, with its surface factor. [J]
template <int Dim> double LatticePart<Dim>::energy_of(std::ptrdiff_t i, std::size_t h, double stretch) const
{
  return surface_factor(i, h) * law::bond_energy(arms_[h].kappa, arms_[h].length, stretch);
}

template <int Dim> void LatticePart<Dim>::save()
{
  if (saved_.current) return;
  saved_.words = words_;
  saved_.traits = traits_;
  saved_.current = true;
}

template <int Dim> void LatticePart<Dim>::restore()
{
  words_ = saved_.words;
  traits_ = saved_.traits;
  saved_.current = true;
  forget_volume();
  runs_stale_ = true;
}

template <int Dim> std::array<std::uint64_t, 2> LatticePart<Dim>::words_of(Index k) const
{
  const auto i = static_cast<std::size_t>(at(where_.active.site(sites_[static_cast<std::size_t>(k)])));
  return {words_[0][i], planes() > 1 ? words_[1][i] : 0};
}

template <int Dim> Site<Dim> LatticePart<Dim>::site_at(std::ptrdiff_t at) const
{
  Site<Dim> site{};
  for (std::size_t d = Dim; d-- > 0; at %= stride_[d]) site[d] = lower_[d] + static_cast<Index>(at / stride_[d]);
  return site;
}

template <int Dim> std::vector<Index> LatticePart<Dim>::halo_sites() const
{
  std::vector<Index> numbers;
  for (const std::ptrdiff_t i : halo_at_) numbers.push_back(number(site_at(i)));
  return numbers;
}

template <int Dim> std::array<std::uint64_t, 2> LatticePart<Dim>::gone_of(Index k) const
{
  const Site<Dim> site = where_.active.site(sites_[static_cast<std::size_t>(k)]);
  const std::ptrdiff_t i = at(site);
  std::array<std::uint64_t, 2> gone{0, 0};
  if (!(traits_[static_cast<std::size_t>(i)] & kLost)) return gone;
  for (std::size_t h = 0; h < arms_.size(); ++h)
    if (!has_bond(i, h) && begins(site, h)) gone[h / 64] |= std::uint64_t{1} << (h % 64);
  return gone;
}

/// Bonds between particles of other ranks stay as they are here: nobody asks, and nobody would break them.
template <int Dim> bool LatticePart<Dim>::is_own(std::ptrdiff_t i, std::size_t arm) const
{
  const auto owned = [this](std::ptrdiff_t k) {
    return k < window_size_ && (traits_[static_cast<std::size_t>(k)] & kOwned);
  };
  return owned(i) || owned(i + arms_[arm].jump);
}

template <int Dim> void LatticePart<Dim>::set_gone(std::span<const std::uint64_t> words)
{
  remember_volume();
  other_words_ = words_;
  const std::size_t count = sites_.size() + halo_at_.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (!(words[2 * k] | words[2 * k + 1])) continue;
    const std::ptrdiff_t i = k < sites_.size() ? at(where_.active.site(sites_[k])) : halo_at_[k - sites_.size()];
    for (std::size_t h = 0; h < arms_.size(); ++h)
      if (words[2 * k + h / 64] >> (h % 64) & 1u && is_own(i, h))
        words_[h / 64][static_cast<std::size_t>(i)] &= ~(std::uint64_t{1} << (h % 64));
  }
  note_losses();
}

template <int Dim> void LatticePart<Dim>::set_gone(std::span<const BondAt> bonds)
{
  remember_volume();
  other_words_ = words_;
  for (const auto& [lower, arm] : bonds)
    if (in_window(lower) && is_own(at(lower), arm))
      words_[arm / 64][static_cast<std::size_t>(at(lower))] &= ~(std::uint64_t{1} << (arm % 64));
  note_losses();
}

template <int Dim> std::int64_t LatticePart<Dim>::bonds() const
{
  std::int64_t count = 0;
  for (std::size_t p = 0; p < planes(); ++p)
    for (const Run& run : segments_)
      for (Index k = 0; k < run.length; ++k) count += std::popcount(words_[p][static_cast<std::size_t>(run.at + k)]);
  return count;
}

template <int Dim> void LatticePart<Dim>::weak_rows(std::vector<Index>& rows) const
{
  double full = 0.0; // stiffness of a full family in any one direction, d trace / Dim, both halves
  for (const HalfArm<Dim>& arm : arms_) full += 2.0 * arm.kappa / arm.length / Dim;
  for (const Run& run : segments_)
    for (Index k = 0; k < run.length; ++k) {
      const std::ptrdiff_t i = run.at + k;
      if (!(traits_[static_cast<std::size_t>(i)] & kLost)) continue;
      Tensor<Dim> stiffness = Tensor<Dim>::Zero();
      for (std::size_t h = 0; h < arms_.size(); ++h) {
        const int there = has_bond(i, h) + has_bond(i - arms_[h].jump, h);
        const Eigen::Map<const Vector<Dim>> xi(arms_[h].xi.data());
        if (there) stiffness += (there * arms_[h].kappa / (arms_[h].length * xi.squaredNorm())) * (xi * xi.transpose());
      }
      Eigen::SelfAdjointEigenSolver<Tensor<Dim>> solver;
      if (solver.computeDirect(stiffness, Eigen::EigenvaluesOnly).eigenvalues()[0] < kWeak * full)
        rows.push_back(run.row + k);
    }
}

/// Particles that lost bonds since the last call are summed anew, by the same arithmetic as all are at first.
template <int Dim> const std::vector<double>& LatticePart<Dim>::bonded_volume_now() const
{
  std::vector<Run> runs;
  if (now_volume_.empty()) {
    double complete = 0.0; // as the kernel sums it up
    for (const Arm<Dim>& arm : stencil_.half) complete += arm.volume_share * stencil_.volume() * 2.0;
    now_volume_.assign(sites_.size(), complete);
    split_runs(segments_, traits_.data(), kComplete | kLost, kComplete, runs);
    std::erase_if(runs, [](const Run& run) { return run.kind == RunKind::whole; });
  } else {
    std::ranges::sort(thinned_);
    thinned_.erase(std::unique(thinned_.begin(), thinned_.end()), thinned_.end());
    for (const std::ptrdiff_t i : thinned_)
      if (traits_[static_cast<std::size_t>(i)] & kOwned)
        runs.push_back({i, local_rows_[static_cast<std::size_t>(i)], 1, RunKind::partial});
  }
  thinned_.clear();
  for (Run& run : runs) {
    run.row -= first_row_;
    std::fill_n(now_volume_.begin() + run.row, run.length, 0.0);
  }
  BondView<Dim> view{};
  view.words = {words_[0].data(), words_[1].data()};
  view.arms = arms_;
  pd::add_bonded_volume<Dim>(view, stencil_, runs, now_volume_.data());
  return now_volume_;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void LatticePart<Dim>::find_traits();                                                                       \
  template void LatticePart<Dim>::make_runs() const;                                                                   \
  template void LatticePart<Dim>::protect(std::span<const geom::Box<2>>);                                              \
  template std::int64_t LatticePart<Dim>::cut(const crack::CrackSet&);                                                 \
  template Broken LatticePart<Dim>::break_bonds(const Window&, BreakRule);                                             \
  template Broken LatticePart<Dim>::lose(LostBonds, Kinematics, field::ForceLosses*);                                  \
  template void LatticePart<Dim>::overstretched(const Window&, BreakRule, std::vector<double>&) const;                 \
  template void LatticePart<Dim>::save();                                                                              \
  template void LatticePart<Dim>::restore();                                                                           \
  template std::array<std::uint64_t, 2> LatticePart<Dim>::words_of(Index) const;                                       \
  template std::vector<Index> LatticePart<Dim>::halo_sites() const;                                                    \
  template std::array<std::uint64_t, 2> LatticePart<Dim>::gone_of(Index) const;                                        \
  template void LatticePart<Dim>::set_gone(std::span<const std::uint64_t>);                                            \
  template void LatticePart<Dim>::set_gone(std::span<const LatticePart<Dim>::BondAt>);                                 \
  template std::int64_t LatticePart<Dim>::bonds() const;                                                               \
  template void LatticePart<Dim>::weak_rows(std::vector<Index>&) const;                                                \
  template const std::vector<double>& LatticePart<Dim>::bonded_volume_now() const
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
