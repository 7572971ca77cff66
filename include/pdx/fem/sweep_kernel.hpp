#pragma once
#include "pdx/base/aligned.hpp"
#include "pdx/base/processor.hpp"
#include "pdx/fem/element.hpp"
#include "pdx/law/elastic.hpp"

#include <array>
#include <cstddef>
#include <span>

namespace pdx::fem {
/// Rows of two components that elements read and add to.
struct SweepFields {
  const double* u = nullptr; ///< displacement of all rows                                  [m]
  std::ptrdiff_t rows = 0;   ///< of u
  double* r = nullptr;       ///< internal force of the first `owned` rows, or nullptr      [N]
  std::ptrdiff_t owned = 0;  ///< rows of r; what acts on others is left out
};

/// Rectangles of one shape side by side, on two lines of rows that count upwards: element k has the corners
/// first[0] + k, first[0] + k + 1, first[1] + k + 1, first[1] + k. Either line is owned or not, as a whole.
struct RectangleRun {
  std::array<Index, 2> first{}; ///< row of the first node of either line
  Index elements = 0;
  double along = 0.0;  ///< from one node of a line to the next; below 0 against the axis    [m]
  double across = 0.0; ///< from the first line to the second; below 0 against the axis      [m]
  bool turned = false; ///< lines go along y, not x
};

/// Any convex cells, W at once: corner a of lane l of block b is rows[(4 b + a) W + l].
struct QuadBlocks {
  AlignedVector<Index> rows;
  /// 8 W numbers a block: derivatives of the place at the Gauss points, twice d(x, y)/d xi where eta = -, + 1/sqrt(3),
  /// then twice d(x, y)/d eta where xi = -, + 1/sqrt(3)                                        [m]
  AlignedVector<double> sides;
  Index elements = 0;  ///< lanes behind the last repeat it and count for nothing
  bool inside = false; ///< all rows are owned
};
/// Appends cells to blocks for a processor's lanes.
/// @param corners counter-clockwise [m]   @param rows of the corners
QuadBlocks quad_blocks(Processor processor, std::span<const std::array<Vector<2>, 4>> corners,
                       std::span<const std::array<Index, 4>> rows);

/// r += internal forces of the elements. They differ by rounding from those of `element_force` (elastic_kernel.hpp),
/// and are zero at rest.
///@{
void add_sweep_forces(Processor processor, std::span<const RectangleRun> runs, const law::Elastic& law,
                      Kinematics kinematics, const SweepFields& fields);
void add_sweep_forces(Processor processor, const QuadBlocks& blocks, const law::Elastic& law, Kinematics kinematics,
                      const SweepFields& fields);
///@}
/// Strain energy of the elements [J]; r is not looked at.
///@{
double sweep_energy(Processor processor, std::span<const RectangleRun> runs, const law::Elastic& law,
                    Kinematics kinematics, const SweepFields& fields);
double sweep_energy(Processor processor, const QuadBlocks& blocks, const law::Elastic& law, Kinematics kinematics,
                    const SweepFields& fields);
///@}
} // namespace pdx::fem
