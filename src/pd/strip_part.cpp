#include "pdx/pd/strip_part.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::pd {
namespace {
/// Room for rounding in the search for overstretched bonds: e is a sum of a few terms of size 1.
constexpr double kRoom = 1e-12, kRounding = 1e-14;
constexpr double kHeadroom = 1.25; // a tile takes the next series before it needs it

bool any_displaced(const double* u, std::ptrdiff_t count)
{
  constexpr std::ptrdiff_t chunk = 32;
  for (std::ptrdiff_t k = 0; k < count; k += chunk) {
    const std::ptrdiff_t end = std::min(count, k + chunk);
    int any = 0;
    for (std::ptrdiff_t i = k; i < end; ++i) any |= u[i] != 0.0;
    if (any) return true;
  }
  return false;
}

Series series_for(double lowest, double highest)
{
  const double worst = std::max(-lowest, highest);
  for (const Series series : {Series::fifth, Series::seventh, Series::eleventh})
    if (worst <= series_range(series)) return series;
  return Series::none;
}
} // namespace

template <int Dim> void StripPart<Dim>::watch(double critical_stretch)
{
  critical_stretch_ = critical_stretch;
  const double e = kinematics_ == Kinematics::linear ? critical_stretch : critical_stretch * (2.0 + critical_stretch);
  threshold_ = e * (1.0 - kRoom) - kRounding;
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
  fill_ghosts<Dim>(processor_, blocks_.data(), lines());
}

template <int Dim> void StripPart<Dim>::load_piece(Piece& piece, const double* owned)
{
  const double* from = owned + static_cast<std::ptrdiff_t>(piece.row) * Dim;
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(piece.length) * Dim;
  const bool filled = any_displaced(from, count);
  if (!filled && !piece.filled) return;
  piece.filled = filled;
  double* to = blocks_.data() + piece.at;
  for (Index k = 0; k < piece.length; ++k, from += Dim, to += StripView<Dim>::kParts * lanes_)
    for (std::ptrdiff_t d = 0; d < Dim; ++d) to[d * lanes_] = from[d];
  std::uint8_t& busy = busy_[static_cast<std::size_t>(piece.tile)];
  if (!filled || busy) return;
  busy = std::any_of(from - count, from, [this](double u) { return !(std::abs(u) <= at_rest_); });
}

/// Tiles whose bonds may have a force, and the lines that these reach.
template <int Dim> void StripPart<Dim>::choose_tiles()
{
  const std::vector<std::uint8_t> near = around(busy_);
  std::vector<std::uint8_t> computed(tasks_.size(), 0);
  chosen_.clear();
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
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
  touched_lines_.clear();
  const Index rows = extent_[1], planes = Dim == 3 ? extent_[Dim - 1] : 1;
  for (Index z = 0; z < planes; ++z)
    for (Index y = 0; y < rows; ++y) {
      const Index row = Dim == 3 ? z / span_[Dim - 1] * tiles_[1] + y / span_[1] : y / span_[1];
      const auto first = touched_.begin() + static_cast<std::ptrdiff_t>(row) * tiles_[0];
      if (std::any_of(first, first + tiles_[0], [](std::uint8_t t) { return t != 0; }))
        touched_lines_.push_back(static_cast<std::ptrdiff_t>(z) * rows + y);
    }
}

template <int Dim> double StripPart<Dim>::energy(double* r)
{
  double sum = 0.0;
  sweep(r, &sum);
  return sum;
}

template <int Dim> void StripPart<Dim>::sweep(double* r, double* energy)
{
  std::int64_t with_bonds = 0;
  for (const StripTask& task : tasks_) with_bonds += task.box.columns != 0;
  computed_ += static_cast<std::int64_t>(chosen_.size());
  skipped_ += with_bonds - static_cast<std::int64_t>(chosen_.size());
  do {
    chosen_tasks_.clear();
    for (const std::size_t t : chosen_) chosen_tasks_.push_back(tasks_[t]);
    if (energy) *energy = 0.0;
    clear_forces<Dim>(processor_, blocks_.data(), lines());
    sweep_strips<Dim>(processor_, view_, kinematics_, chosen_tasks_, energy);
  } while (raise_series());
  if (!r) return;
  fold_ghosts<Dim>(processor_, blocks_.data(), lines());
  unload(r);
}

/// Chooses the series of the next pass by what this one saw. @return true if a tile of this one needed a better series
template <int Dim> bool StripPart<Dim>::raise_series()
{
  bool insufficient = false;
  for (std::size_t k = 0; k < chosen_.size(); ++k) {
    StripTask& task = tasks_[chosen_[k]];
    task = chosen_tasks_[k];
    if (kinematics_ == Kinematics::linear) continue;
    insufficient |= series_for(task.lowest, task.highest) > task.series;
    task.series = series_for(kHeadroom * task.lowest, kHeadroom * task.highest);
  }
  return insufficient;
}

template <int Dim> void StripPart<Dim>::unload(double* r)
{
  const std::ptrdiff_t stride = StripView<Dim>::kParts * lanes_;
  for (const Piece& piece : pieces_) {
    if (!touched_[static_cast<std::size_t>(piece.tile)]) continue;
    const double* force = blocks_.data() + piece.at + Dim * lanes_;
    double* to = r + static_cast<std::ptrdiff_t>(piece.row) * Dim;
    for (Index k = 0; k < piece.length; ++k, to += Dim, force += stride)
      for (std::ptrdiff_t d = 0; d < Dim; ++d) to[d] -= force[d * lanes_];
  }
}

template <int Dim> bool StripPart<Dim>::overstretched_seen() const
{
  return std::any_of(tasks_.begin(), tasks_.end(), [this](const StripTask& t) { return t.highest > threshold_; });
}

template <int Dim> Broken StripPart<Dim>::break_bonds()
{
  found_.clear();
  for (StripTask& task : tasks_) {
    if (!(task.highest > threshold_)) continue;
    find_overstretched<Dim>(processor_, view_, task.box, kinematics_, critical_stretch_, found_);
    task.highest = 0.0;
  }
  std::vector<LostBond<Dim>> lost;
  for (const StripBond& bond : found_) {
    const std::ptrdiff_t line = bond.vector / pitch_, column = bond.vector % pitch_ - stencil_reach_;
    const std::ptrdiff_t site = line * part_.extent()[0] + bond.lane * columns_ + column;
    if (part_.protects(site, bond.arm)) continue;
    words_[bond.arm / 64].data()[bond.vector * lanes_ + bond.lane] &= ~arms_[bond.arm].bit;
    const double* u = blocks_.data() + bond.vector * StripView<Dim>::kParts * lanes_ + bond.lane;
    Vector<Dim> eta;
    for (int d = 0; d < Dim; ++d) eta[d] = u[arms_[bond.arm].jump + d * lanes_] - u[d * lanes_];
    lost.push_back({site, bond.arm, eta});
  }
  return part_.lose(lost, kinematics_);
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void StripPart<Dim>::watch(double);                                                                         \
  template void StripPart<Dim>::load(std::span<const double>);                                                         \
  template void StripPart<Dim>::sweep(double*, double*);                                                               \
  template double StripPart<Dim>::energy(double*);                                                                     \
  template bool StripPart<Dim>::overstretched_seen() const;                                                            \
  template Broken StripPart<Dim>::break_bonds()
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
} // namespace pdx::pd
