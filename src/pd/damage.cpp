#include "pdx/pd/damage.hpp"

namespace pdx::pd {
template <int Dim>
void add_bonded_volume(const BondView<Dim>& view, const Stencil<Dim>& stencil, std::span<const Run> runs, double* sum)
{
  const double volume = stencil.volume();
  for (const Run& run : runs)
    for (std::size_t h = 0; h < view.arms.size(); ++h) {
      const double part = stencil.half[h].volume_share * volume;
      const std::uint64_t* from_here = view.words[h / 64] + run.at;
      const std::uint64_t* to_here = from_here - view.arms[h].jump;
      for (Index k = 0; k < run.length; ++k)
        sum[run.row + k] += part * static_cast<double>((from_here[k] >> h % 64 & 1u) + (to_here[k] >> h % 64 & 1u));
    }
}
template void add_bonded_volume<2>(const BondView<2>&, const Stencil<2>&, std::span<const Run>, double*);
template void add_bonded_volume<3>(const BondView<3>&, const Stencil<3>&, std::span<const Run>, double*);

double damage(const BondedVolume& volume)
{
  return volume.whole > 0.0 && volume.start != volume.now ? (volume.start - volume.now) / volume.whole : 0.0;
}
double precrack_share(const BondedVolume& volume)
{
  return volume.whole > 0.0 && volume.whole != volume.start ? (volume.whole - volume.start) / volume.whole : 0.0;
}
} // namespace pdx::pd
