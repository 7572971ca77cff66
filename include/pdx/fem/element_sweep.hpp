#pragma once
#include "pdx/fem/shape.hpp"
#include "pdx/fem/sweep_kernel.hpp"

#include <functional>
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
  /// An element by its number.
  using Source = std::function<Element(Index)>;
  ElementSweep() = default;
  /// Numbered as they stand there. @param owned rows from this number on take no force
  ElementSweep(const law::Elastic& law, Kinematics kinematics, std::span<const Element> elements, Index owned,
               Processor processor = chosen_processor());
  /// @param numbers ascending
  ElementSweep(const law::Elastic& law, Kinematics kinematics, std::span<const Index> numbers, const Source& element,
               Index owned, Processor processor = chosen_processor());

  /// What is different from now on.
  struct Change {
    std::span<const Index> leaving, entering; ///< numbers, ascending
    /// Per local row before, if these are others: local row now, in the same order.
    std::span<const Index> rows = {};
    Index owned;
  };
  /// To the last bit as made of what is there now, in time that grows with what changes, with runs, and with elements
  /// in none. @param element as it is now
  void change(const Change& change, const Source& element);

  /// r += internal force [N]. @param u two per row [m]   @param r two per owned row
  void add_force(std::span<const double> u, std::span<double> r) const;
  double energy(std::span<const double> u) const; ///< of the elements counted here [J]
  Index in_runs() const;                          ///< elements in runs

private:
  struct Part {
    bool counted;
    std::vector<RectangleRun> runs;          // by their first rows
    std::vector<std::vector<Index>> members; // numbers of the elements of each
    std::vector<Index> rest;                 // of those in none, ascending
    std::vector<QuadBlocks> blocks;          // of these
    bool crowded = false;                    // two elements begin at one row: runs depend on more than those beside
  };
  struct Pool;
  Pool open(Part& part, const Change& change) const;
  void lay(Part& part, Pool pool, const Source& element) const;
  void fill_blocks(Part& part, const Source& element) const;

  law::Elastic law_;
  Kinematics kinematics_ = Kinematics::small;
  Processor processor_ = Processor::any;
  Index owned_ = 0;
  std::vector<Part> parts_;
};
} // namespace pdx::fem
