#include "pdx/pd/strip_part.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pdx::pd {
namespace {
/// Room for rounding in the search for overstretched bonds: e is a sum of a few terms of size 1.
constexpr double kRoom = 1e-12, kLeastRoom = 1e-14;

bool any_displaced(const double* u, std::ptrdiff_t count)
{
  constexpr std::ptrdiff_t chunk = 32;
  for (std::ptrdiff_t k = 0; k < count; k += chunk) {
    std::uint64_t bits = 0;
    for (std::ptrdiff_t i = k; i < std::min(count, k + chunk); ++i) bits |= std::bit_cast<std::uint64_t>(u[i]);
    if (bits << 1) return true; // without the sign: -0 is 0
  }
  return false;
}

/// Calls visit(k, d, place in the blocks from the first row's) for `count` neighbouring rows of one strip.
template <int Dim, int W, class Visit> void for_each_entry(Index count, Visit&& visit)
{
  for (std::ptrdiff_t k = 0; k < count; ++k)
    for (std::ptrdiff_t d = 0; d < Dim; ++d) visit(k * Dim + d, (k * StripView<Dim>::kParts + d) * W);
}
/// The same with the number of lanes known to the compiler.
template <int Dim, class Visit> void for_each_entry(int lanes, Index count, Visit&& visit)
{
  if (lanes == 8)
    for_each_entry<Dim, 8>(count, visit);
  else if (lanes == 4)
    for_each_entry<Dim, 4>(count, visit);
  else
    for_each_entry<Dim, 2>(count, visit);
}

Series series_for(double lowest, double highest)
{
  const double worst = std::max(-lowest, highest);
  for (const Series series : {Series::fifth, Series::seventh, Series::eleventh})
    if (worst <= series_range(series)) return series;
  return Series::none;
}
} // namespace

/// What e of a bond must exceed to break it.
template <int Dim> double StripPart<Dim>::limit_of(double stretch) const
{
  return kinematics_ == Kinematics::small ? stretch : stretch * (2.0 + stretch);
}

template <int Dim> void StripPart<Dim>::watch(double critical_stretch)
{
  critical_stretch_ = least_stretch_ = critical_stretch;
  threshold_ = limit_of(critical_stretch) * (1.0 - kRoom) - kLeastRoom;
  thresholds_.clear();
  if (part_.stretches_vary()) {
    watch_tiles();
    least_stretch_ = std::numeric_limits<double>::infinity();
    for (double& least : thresholds_) {
      least_stretch_ = std::min(least_stretch_, critical_stretch_ * least);
      least = limit_of(critical_stretch_ * least) * (1.0 - kRoom) - kLeastRoom;
    }
  }
  for (std::size_t t = 0; t < tasks_.size(); ++t) tasks_[t].limit = threshold(t);
}

template <int Dim> void StripPart<Dim>::load(std::span<const double> owned)
{
  std::fill(busy_.begin(), busy_.end(), std::uint8_t{at_rest_ < 0.0});
  const std::span<const double> halo = part_.exchange(owned, [&] {
    for (Piece& piece : pieces_) load_piece(piece, owned.data());
  });
  for (std::size_t k = 0; k * Dim < halo.size(); ++k)
    for (std::size_t d = 0; d < Dim; ++d) {
      const double u = halo[k * Dim + d];
      blocks_.data()[halo_[k].at + static_cast<std::ptrdiff_t>(d) * lanes_] = u;
      if (!(std::abs(u) <= at_rest_)) busy_[static_cast<std::size_t>(halo_[k].tile)] = 1;
    }
  choose_tiles();
}

template <int Dim> void StripPart<Dim>::load_piece(Piece& piece, const double* owned)
{
  const double* from = owned + static_cast<std::ptrdiff_t>(piece.row) * Dim;
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(piece.length) * Dim;
  if (!piece.filled && !any_displaced(from, count)) return;
  piece.filled = true;
  double* to = blocks_.data() + piece.at;
  for_each_entry<Dim>(lanes_, piece.length, [&](std::ptrdiff_t row, std::ptrdiff_t block) { to[block] = from[row]; });
  std::uint8_t& busy = busy_[static_cast<std::size_t>(piece.tile)];
  if (busy) return;
  busy = std::any_of(from, from + count, [this](double u) { return !(std::abs(u) <= at_rest_); });
}

/// Tiles whose bonds may have a force, and the lines that these reach.
template <int Dim> void StripPart<Dim>::choose_tiles()
{
  const std::vector<std::uint8_t> near = around(busy_);
  std::vector<std::uint8_t> computed(tasks_.size(), 0);
  chosen_.clear();
  touched_lines_.clear();
  const std::size_t per_slab = slabs() ? tasks_.size() / static_cast<std::size_t>(slabs()) : 1;
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    if (t % per_slab == 0) slab_[t / per_slab].tasks = chosen_.size();
    if (!tasks_[t].box.columns) continue;
    if (near[t]) {
      computed[t] = 1;
      chosen_.push_back(t);
    } else {
      tasks_[t].series = Series::fifth; // as if it had been computed
      tasks_[t].lowest = tasks_[t].highest = 0.0;
    }
  }
  touched_ = around(computed);
  const Index rows = extent_[1], planes = Dim == 3 ? extent_[Dim - 1] : 1;
  for (Index z = 0; z < planes; ++z)
    for (Index y = 0; y < rows; ++y) {
      const Index last = Dim == 3 ? z : y;
      if (last % span_[Dim - 1] == 0 && (Dim == 2 || y == 0))
        slab_[static_cast<std::size_t>(last / span_[Dim - 1])].lines = touched_lines_.size();
      const Index row = Dim == 3 ? z / span_[Dim - 1] * tiles_[1] + y / span_[1] : y / span_[1];
      const auto first = touched_.begin() + static_cast<std::ptrdiff_t>(row) * tiles_[0];
      if (std::any_of(first, first + tiles_[0], [](std::uint8_t t) { return t != 0; }))
        touched_lines_.push_back(static_cast<std::ptrdiff_t>(z) * rows + y);
    }
  slab_.back().tasks = chosen_.size();
  slab_.back().lines = touched_lines_.size();
}

template <int Dim> std::span<StripTask> StripPart<Dim>::tasks_of(Index slab)
{
  const auto s = static_cast<std::size_t>(slab);
  return std::span(chosen_tasks_).subspan(slab_[s].tasks, slab_[s + 1].tasks - slab_[s].tasks);
}

template <int Dim> StripLines StripPart<Dim>::lines_of(Index slab) const
{
  const auto s = static_cast<std::size_t>(slab);
  return {columns_, stencil_reach_,
          std::span(touched_lines_).subspan(slab_[s].lines, slab_[s + 1].lines - slab_[s].lines)};
}

template <int Dim> double StripPart<Dim>::energy(double* r)
{
  sweep(r, true);
  double sum = 0.0;
  for (const StripTask& task : chosen_tasks_) sum += task.energy;
  return sum;
}

/// Slab by slab, so that what a slab needs stays in the cache from the first look to the last.
template <int Dim> void StripPart<Dim>::sweep(double* r, bool energetic)
{
  std::int64_t with_bonds = 0;
  for (const StripTask& task : tasks_) with_bonds += task.box.columns != 0;
  computed_ += static_cast<std::int64_t>(chosen_.size());
  skipped_ += with_bonds - static_cast<std::int64_t>(chosen_.size());
  chosen_tasks_.clear();
  for (const std::size_t t : chosen_) chosen_tasks_.push_back(tasks_[t]);
  for (Index slab = 0; slab < slabs(); ++slab) {
    for (Index next = slab ? slab + slabs_reached() : 0; next <= slab + slabs_reached(); ++next) prepare(next);
    sweep_slab(slab, energetic);
    if (!r) continue;
    fold_ghosts<Dim>(processor_, blocks_.data(), lines_of(slab));
    unload(slab, r);
  }
  for (std::size_t k = 0; k < chosen_.size(); ++k) tasks_[chosen_[k]] = chosen_tasks_[k];
}

template <int Dim> void StripPart<Dim>::prepare(Index slab)
{
  if (slab >= slabs()) return;
  fill_ghosts<Dim>(processor_, blocks_.data(), lines_of(slab));
  clear_forces<Dim>(processor_, blocks_.data(), lines_of(slab));
}

/// Each tile begins with the series of its last step. Where that turns out to be another than its bonds need, all that
/// reaches the slab is added up again: forces depend on the state alone, to the last bit, and not on how it was
/// reached.
template <int Dim> void StripPart<Dim>::sweep_slab(Index slab, bool energetic)
{
  sweep_strips<Dim>(processor_, view_, kinematics_, tasks_of(slab), energetic);
  bool wrong = false;
  for (StripTask& task : tasks_of(slab)) {
    const Series needed = series_for(task.lowest, task.highest);
    if (kinematics_ == Kinematics::small || needed == task.series) continue;
    task.series = needed;
    wrong = true;
  }
  if (!wrong) return;
  for (Index q = slab; q <= slab + slabs_reached(); ++q) prepare(q);
  for (Index q = std::max(0, slab - slabs_reached()); q <= slab; ++q) // slabs before this one are done with
    sweep_strips<Dim>(processor_, view_, kinematics_, tasks_of(q), energetic);
}

template <int Dim> void StripPart<Dim>::unload(Index slab, double* r) const
{
  const auto s = static_cast<std::size_t>(slab);
  for (std::size_t k = slab_[s].pieces; k < slab_[s + 1].pieces; ++k) {
    const Piece& piece = pieces_[k];
    if (!touched_[static_cast<std::size_t>(piece.tile)]) continue;
    const double* force = view_.blocks + piece.at + Dim * lanes_;
    double* to = r + static_cast<std::ptrdiff_t>(piece.row) * Dim;
    for_each_entry<Dim>(lanes_, piece.length,
                        [&](std::ptrdiff_t row, std::ptrdiff_t block) { to[row] -= force[block]; });
  }
}

template <int Dim> bool StripPart<Dim>::overstretched_seen() const
{
  for (std::size_t t = 0; t < tasks_.size(); ++t)
    if (tasks_[t].highest > threshold(t)) return true;
  return false;
}

/// Judges a bond by the critical stretch of its own regions, by the arithmetic of strip_breaker.cpp, on either rank
/// alike.
template <int Dim> bool StripPart<Dim>::is_over(std::ptrdiff_t site, std::size_t arm, const Vector<Dim>& eta) const
{
  double growth = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    const double xi = arms_[arm].xi[d], by = eta[static_cast<Eigen::Index>(d)];
    growth += kinematics_ == Kinematics::small ? xi * by : (2.0 * xi + by) * by;
  }
  const double length = arms_[arm].length;
  return growth > limit_of(critical_stretch_ * part_.stretch_factor(site, arm)) * length * length;
}

template <int Dim> Broken StripPart<Dim>::break_bonds(field::ForceLosses* losses)
{
  found_.clear();
  StripView<Dim> breakable = view_;
  if (part_.protects_any()) breakable.words = {breakable_[0].data(), breakable_[1].data()};
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    StripTask& task = tasks_[t];
    if (!(task.highest > threshold(t))) continue;
    find_overstretched<Dim>(processor_, breakable, task.closer(), kinematics_, least_stretch_, found_);
    task.highest = 0.0;
  }
  std::vector<LostBond<Dim>> lost;
  for (const StripBond& bond : found_) {
    const std::ptrdiff_t line = bond.vector / pitch_, column = bond.vector % pitch_ - stencil_reach_;
    const std::ptrdiff_t site = line * part_.extent()[0] + bond.lane * columns_ + column;
    const double* u = blocks_.data() + bond.vector * StripView<Dim>::kParts * lanes_ + bond.lane;
    Vector<Dim> eta;
    for (int d = 0; d < Dim; ++d) eta[d] = u[arms_[bond.arm].jump + d * lanes_] - u[d * lanes_];
    if (!thresholds_.empty() && !is_over(site, bond.arm, eta)) continue;
    for (auto* words : {&words_, &breakable_})
      if (std::uint64_t* const first = (*words)[bond.arm / 64].data())
        first[bond.vector * lanes_ + bond.lane] &= ~arms_[bond.arm].bit;
    lost.push_back({site, bond.arm, eta});
  }
  return part_.lose(lost, kinematics_, losses);
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void StripPart<Dim>::watch(double);                                                                         \
  template void StripPart<Dim>::load(std::span<const double>);                                                         \
  template void StripPart<Dim>::sweep(double*, bool);                                                                  \
  template double StripPart<Dim>::energy(double*);                                                                     \
  template bool StripPart<Dim>::overstretched_seen() const;                                                            \
  template Broken StripPart<Dim>::break_bonds(field::ForceLosses*)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
