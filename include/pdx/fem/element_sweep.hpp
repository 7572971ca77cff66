#pragma once
#include "pdx/fem/shape.hpp"
#include "pdx/fem/sweep_kernel.hpp"

#include <vector>

namespace pdx::fem {
/// Elements of one material, sorted by what is fastest: rectangles in runs where rows of their nodes follow each other,
/// all others in lanes. Sums are taken in an order that depends on the elements and the processor alone.
class ElementSweep {
public:
  struct Element {
    Corners corners;           ///< counter-clockwise [m]
    std::array<Index, 4> rows; ///< of the corners, local
    bool counted;              ///< its energy is counted here
  };
  ElementSweep() = default;
  /// @param owned rows from this number on take no force
  ElementSweep(const law::Elastic& law, Kinematics kinematics, std::span<const Element> elements, Index owned,
               Processor processor = chosen_processor());

  /// r += internal force [N]. @param u two per row [m]   @param r two per owned row
  void add_force(std::span<const double> u, std::span<double> r) const;
  double energy(std::span<const double> u) const; ///< of the elements counted here [J]
  Index in_runs() const;                          ///< elements in runs

private:
  struct Part {
    bool counted;
    std::vector<RectangleRun> runs;
    std::vector<QuadBlocks> blocks;
  };

  law::Elastic law_;
  Kinematics kinematics_ = Kinematics::small;
  Processor processor_ = Processor::any;
  std::vector<Part> parts_;
};
} // namespace pdx::fem
