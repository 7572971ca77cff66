#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/base/tensor.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

/// Forces of bonds from particles in line to points in line, lanes of neighbours at a time.
namespace pdx::couple {
/// Places in line are counted in blocks of 8, whatever the lanes of the processor.
constexpr int kRunBlock = 8;
/// All that a tile has in line is in its scratch. Of each line it has displacements by direction, forces by direction,
/// and 1 where a particle's bonds are counted in the energy, else 0.
template <int Dim> constexpr int kRunParts = 2 * Dim + 1;

/// Bonds that are alike, from places in line to the places of another line, some further.
template <int Dim> struct Run {
  Index from = 0, to = 0;       ///< first place of either line in the scratch
  Index blocks = 0;             ///< of 8 bonds
  std::array<double, Dim> xi{}; ///< reference vector                                         [m]
  double per_square = 0.0;      ///< 1 / |xi|^2                                               [1/m^2]
  double limit = 0.0;           ///< of e, see `StripTask`: is it passed? Infinite: nobody asks [-]
  std::ptrdiff_t stiffness = 0; ///< where those of its bonds begin
};

/// Eight particles next to each other in the scratch.
struct RunParticles {
  Index at = 0;            ///< first place in the scratch
  Index row = -1;          ///< of the first where the others follow and all are owned, else -1
  std::ptrdiff_t rows = 0; ///< else where their 8 rows are told; -1: nobody is there
};

/// Eight points next to each other in the scratch, and the rows that carry them.
struct RunPoints {
  Index at = 0;               ///< first place in the scratch
  Index hosts = 0;            ///< rows that carry any of them
  std::ptrdiff_t host = 0;    ///< where these are told, by their numbers in the tile
  std::ptrdiff_t weights = 0; ///< 8 for each of them
};

/// What is worked off at once: a piece of a straight side and the particles before it. Each entry is where it ends in
/// the lists of the view; the tile before says where it begins.
struct RunTile {
  std::size_t particles = 0, points = 0, runs = 0, rows = 0;
};

template <int Dim> struct RunView {
  std::span<const RunTile> tiles;
  std::span<const RunParticles> particles;
  std::span<const RunPoints> points;
  std::span<const Run<Dim>> runs;
  std::span<const Index> rows;          ///< of the tiles' hosts, local
  const Index* particle_rows = nullptr; ///< local
  const Index* hosts = nullptr;
  const double* weights = nullptr;
  const double* stiffness = nullptr; ///< kappa / |xi| of each bond, 0 of those that are gone or never were [N/m]
  Index pitch = 0;                   ///< of a line in the scratch
  double* scratch = nullptr;         ///< forces in it are 0 before and after
  double* sums = nullptr;            ///< Dim x 8 for each row of a tile, likewise
  std::uint8_t* far = nullptr;       ///< per tile: were its bonds far from their lengths the last time?
};

/// r += forces of the bonds on owned rows at displacement u: kappa s n at the particle, its opposite shared among
/// hosts.
/// @param finite stretch of the turned bond, else along the reference   @return was a limit passed?
template <int Dim>
bool add_run_forces(Processor processor, const RunView<Dim>& view, bool finite, const double* u, Index owned,
                    double* r);
/// r += forces of the bonds on owned rows at displacement u: kappa s n at the particle, its opposite shared among
/// hosts.
/// @param finite stretch of the turned bond, else along the reference   @return was a limit passed?
template <int Dim>
bool add_run_forces(Processor processor, const RunView<Dim>& view, bool finite, const double* u, Index owned,
                    double* r);
/// Strain energy of the bonds from owned rows at displacement u [J].
template <int Dim>
double run_energy(Processor processor, const RunView<Dim>& view, bool finite, const double* u, Index owned);
} // namespace pdx::couple
