#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/mpm/cell_points.hpp"

#include <cstddef>
#include <span>

/// Forces of cells on the corners of their grid by quadrature over material points, lanes of cells at a time, nothing
/// stored per point. Rows are local blocks of Dim values.
namespace pdx::mpm {
template <int Dim> using CellRows = std::array<Index, kCorners<Dim>>;

/// Full cells one after the other along x, in space along z, whose corners are rows in a row: of each of the lines of
/// nodes (in space x fastest, then y) the row of its first node. All rows may be written.
template <int Dim> struct CellRun {
  static constexpr std::size_t kLines = kCorners<Dim> / 2;
  /// Corner of a cell at the lower end of a line; that at its upper end is kStep behind.
  static constexpr std::size_t corner(std::size_t line) { return Dim == 2 ? 2 * line : line; }
  static constexpr std::size_t kStep = Dim == 2 ? 1 : kLines;

  std::array<Index, kLines> first{};
  Index cells = 0;

  CellRows<Dim> rows(Index cell) const
  {
    CellRows<Dim> all{};
    for (std::size_t line = 0; line < kLines; ++line) {
      all[corner(line)] = first[line] + cell;
      all[corner(line) + kStep] = first[line] + cell + 1;
    }
    return all;
  }
};

/// What a sweep reads and adds to.
struct NodeFields {
  const double* u = nullptr; ///< displacement [m]
  const double* v = nullptr; ///< velocity, for viscous forces only [m/s]
  double* r = nullptr;       ///< forces of rows 0 to owned - 1 [N]
  Index owned = 0;
  /// If given, lanes of cells that rest are left out, which changes no bit, and counted here: those with no
  /// displacement at any corner, of viscous forces no velocity.
  std::int64_t* skipped = nullptr;
};

/// `add_run_forces` knows full cells of so many points in each direction.
constexpr bool runs_are_swept(int ratio) { return ratio == 1 || ratio == 2; }

/// r += internal force of cells with the given points.
///@{
template <int Dim>
void add_run_forces(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& full,
                    std::span<const CellRun<Dim>> runs, const NodeFields& fields);
template <int Dim>
void add_cell_forces(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& points,
                     std::span<const CellRows<Dim>> cells, const NodeFields& fields);
///@}
/// Strain energy [J].
template <int Dim>
double cell_energy(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& points,
                   std::span<const CellRows<Dim>> cells, const double* u);

/// r += force of linear bulk viscosity: first Piola stress b rho c_L h tr(D) cof F, with tr(D) = cof F : dF/dt / J.
/// Rigid motion feels none of it. @param b [-]   @return what it takes from motion [W]
///@{
template <int Dim>
double add_run_viscous(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& full, double b,
                       std::span<const CellRun<Dim>> runs, const NodeFields& fields);
template <int Dim>
double add_cell_viscous(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& points, double b,
                        std::span<const CellRows<Dim>> cells, const NodeFields& fields);
///@}
} // namespace pdx::mpm
