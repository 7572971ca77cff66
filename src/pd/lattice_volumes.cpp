#include "pdx/pd/lattice_part.hpp"

// The volume that the particles of a part are bonded to, at three times.
namespace pdx::pd {
template <int Dim> void LatticePart<Dim>::forget_volume() const
{
  now_volume_.clear();
  thinned_.clear();
}

template <int Dim> void LatticePart<Dim>::remember_volume()
{
  if (whole_volume_.empty()) whole_volume_ = start_volume_ = bonded_volume_now();
}

template <int Dim> void LatticePart<Dim>::add_bonded_volume(std::span<BondedVolume> volumes) const
{
  const std::vector<double>& now = bonded_volume_now();
  const bool changed = !whole_volume_.empty();
  for (std::size_t k = 0; k < now.size(); ++k) {
    BondedVolume& volume = volumes[static_cast<std::size_t>(first_row_) + k];
    volume.whole += changed ? whole_volume_[k] : now[k];
    volume.start += changed ? start_volume_[k] : now[k];
    volume.now += now[k];
  }
}

/// Appends local rows of particles that lost volume to load, ascending.
template <int Dim> void LatticePart<Dim>::add_thinned(std::vector<Index>& rows) const
{
  const std::vector<double>& now = bonded_volume_now();
  for (std::size_t k = 0; k < start_volume_.size(); ++k)
    if (start_volume_[k] != now[k]) rows.push_back(first_row_ + static_cast<Index>(k));
}

template <int Dim> void LatticePart<Dim>::add_bonded_volume(Index row, BondedVolume& volume) const
{
  const std::vector<double>& now = bonded_volume_now();
  if (row < first_row_ || row >= first_row_ + std::ssize(now)) return;
  const auto k = static_cast<std::size_t>(row - first_row_);
  const bool changed = !whole_volume_.empty();
  volume.whole += changed ? whole_volume_[k] : now[k];
  volume.start += changed ? start_volume_[k] : now[k];
  volume.now += now[k];
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void LatticePart<Dim>::forget_volume() const;                                                               \
  template void LatticePart<Dim>::remember_volume();                                                                   \
  template void LatticePart<Dim>::add_bonded_volume(std::span<BondedVolume>) const;                                    \
  template void LatticePart<Dim>::add_thinned(std::vector<Index>&) const;                                              \
  template void LatticePart<Dim>::add_bonded_volume(Index, BondedVolume&) const
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
