#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/pd/bond_kernel.hpp"

#include <array>
#include <limits>
#include <vector>

namespace pdx::pd {
/// One half arm laid on lane strips.
template <int Dim> struct StripArm {
  std::ptrdiff_t jump = 0;      ///< from the block of i to that of j = i + xi, in doubles           [-]
  std::array<double, Dim> xi{}; ///< x_j - x_i in the reference                                       [m]
  double per_square = 0.0;      ///< 1 / |xi|^2                                                       [1/m^2]
  double stiffness = 0.0;       ///< kappa / |xi|                                                     [N/m]
  double length = 0.0;          ///< |xi|                                                             [m]
  std::uint64_t bit = 0;        ///< of the bond in its word
};

/// A window in lane strips. Every x-line is cut in W strips of equal length; lane l of a vector is strip l, so that the
/// neighbours of W particles are one aligned vector. On either side of a strip `reach` ghost columns repeat the
/// neighbouring strips. Each vector has a block of 2 Dim x W doubles: displacement by component, then force.
/// Beyond the last line there is room for the neighbours of any vector that has a bond.
template <int Dim> struct StripView {
  static constexpr int kParts = 2 * Dim;
  double* blocks = nullptr;
  std::array<const std::uint64_t*, 2> words{}; ///< bit h % 64 of words[h / 64][vector * W + lane]
  const std::uint16_t* classes = nullptr;      ///< per vector: which surface factors the bonds that start there have;
                                               ///< 0: all 1; nullptr: 0 everywhere
  const double* factors = nullptr; ///< of class c, half arm h and lane l: (c * arms + h) * W + l            [-]
  const double* ends = nullptr;    ///< 1/2 for sites whose half of a bond's energy counts here, else 0            [-]
  std::span<const StripArm<Dim>> arms;
};

/// A box of vectors: `columns` one after the other on each of lines x planes lines.
struct StripBox {
  std::ptrdiff_t first = 0; ///< vector
  int columns = 0, lines = 0, planes = 1;
  std::ptrdiff_t line = 0, plane = 0; ///< vectors from a line or plane to the next
};

/// How exactly e = |xi + eta|^2 / |xi|^2 - 1 becomes s / (1 + s) = 1 - 1/sqrt(1 + e): by polynomials, each to rounding
/// for |e| up to `series_range`, or by root and division for any e.
enum class Series : std::uint8_t { fifth, seventh, eleventh, none };
constexpr double series_range(Series series)
{
  constexpr double ranges[] = {0.005, 0.02, 0.1};
  return series == Series::none ? 1e300 : ranges[static_cast<int>(series)];
}

/// Lines of a window: `columns` vectors each, and `ghosts` more on either side.
struct StripLines {
  int columns = 0, ghosts = 0;
  std::span<const std::ptrdiff_t> lines; ///< numbers of the lines meant
  std::ptrdiff_t pitch() const { return columns + 2 * ghosts; }
};
/// Copies displacements to the ghost columns.
template <int Dim> void fill_ghosts(Processor processor, double* blocks, const StripLines& at);
/// Adds forces of ghost columns to those they are the ghosts of.
template <int Dim> void fold_ghosts(Processor processor, double* blocks, const StripLines& at);
/// Sets forces to 0, those of ghosts too.
template <int Dim> void clear_forces(Processor processor, double* blocks, const StripLines& at);

/// A box to sweep and what was seen there.
struct StripTask {
  StripBox box;
  Series series = Series::none;
  bool scaled = false;  ///< some of its bonds have a surface factor
  double lowest = 0.0;  ///< least e (finite) or s (linear) of its intact bonds, at most 0      [-]
  double highest = 0.0; ///< largest, at least 0                                                [-]
  double energy = 0.0;  ///< strain energy by ends, if asked for                                [J]
  double limit = std::numeric_limits<double>::infinity(); ///< of e or s, above which a bond is worth a closer look [-]
  std::array<int, 2> lines{}, planes{}; ///< of the box, from the first to behind the last with such a bond

  /// The part of the box that has all bonds above the limit.
  StripBox closer() const
  {
    StripBox part = box;
    part.first += planes[0] * box.plane + lines[0] * box.line;
    part.lines = lines[1] - lines[0];
    part.planes = planes[1] - planes[0];
    return part;
  }
};

/// Adds the forces of the bonds that start in the boxes to the blocks of both ends: kappa s n on i, its opposite on j.
/// Ghost columns hold displacement before and forces to fold after.
/// Forces differ by rounding from those of `add_force` (bond_kernel.hpp) wherever lowest and highest are within the
/// range of the series.
template <int Dim>
void sweep_strips(Processor processor, const StripView<Dim>& view, Kinematics kinematics, std::span<StripTask> tasks,
                  bool energetic);

/// A bond in a StripView: half arm `arm` of one lane of one vector.
struct StripBond {
  std::ptrdiff_t vector;
  int lane;
  std::uint32_t arm;
};
/// Appends the intact bonds that start in the box and have s > critical_stretch: those that `break_bonds` (breaker.hpp)
/// would break, by its arithmetic to the last bit.
template <int Dim>
void find_overstretched(Processor processor, const StripView<Dim>& view, const StripBox& box, Kinematics kinematics,
                        double critical_stretch, std::vector<StripBond>& bonds);
} // namespace pdx::pd
