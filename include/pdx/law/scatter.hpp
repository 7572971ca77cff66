#pragma once
#include <cstdint>
#include <span>

namespace pdx::law {
/// How the stretch at which bonds break varies from place to place: s0 (1 + width (z_i + z_j) / 2) for the bond of two
/// particles, z even in -1 to 1. It hangs on the sites alone, whatever patch or rank has their particles.
struct Scatter {
  double width = 0.0;     ///< [-]
  std::uint64_t seed = 1; ///< of another draw

  bool any() const { return width != 0.0; }
  double least() const { return 1.0 - width; } ///< no bond has less of s0 [-]
  /// z of a site by its numbers in the lattice of the body. splitmix64: Steele, Lea, Flood 2014.            [-]
  double at(std::span<const std::int64_t> site) const
  {
    std::uint64_t h = mixed(seed);
    for (const std::int64_t k : site) h = mixed(h + static_cast<std::uint64_t>(k));
    return static_cast<double>(h >> 11u) * 0x1p-52 - 1.0;
  }
  /// What a site gives to the factor on s0 of each of its bonds [-].
  double share(std::span<const std::int64_t> site) const { return 0.5 * width * at(site); }

private:
  static std::uint64_t mixed(std::uint64_t h)
  {
    h += 0x9e3779b97f4a7c15u;
    h = (h ^ (h >> 30u)) * 0xbf58476d1ce4e5b9u;
    h = (h ^ (h >> 27u)) * 0x94d049bb133111ebu;
    return h ^ (h >> 31u);
  }
};
} // namespace pdx::law
