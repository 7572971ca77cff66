#pragma once
#include "pdx/base/aligned.hpp"
#include "pdx/base/petsc.hpp"
#include "pdx/mpm/grid_kernel.hpp"

#include <vector>

namespace pdx::mpm {
/// The nodes of a box of a grid, in which this rank's points are, and how their sums meet those of other ranks.
template <int Dim> class GridNodes {
public:
  /// @param lower, upper numbers of the corner nodes, both within
  GridNodes() = default;
  GridNodes(MPI_Comm comm, const Site<Dim>& lower, const Site<Dim>& upper);
  /// Says which nodes this rank's points see now, at most: a box of them, in that of all. Collective.
  void share(const Site<Dim>& lower, const Site<Dim>& upper);

  const NodeView<Dim>& view() const { return view_; }
  std::span<const double> mass() const { return {view_.mass, size_}; }
  std::size_t size() const { return size_; } ///< of each list, a multiple of 8
  const Site<Dim>& lower() const { return lower_; }
  const Site<Dim>& upper() const { return upper_; }
  std::size_t number(const Site<Dim>& node) const; ///< of a node in the box
  bool owned(std::size_t node) const
  {
    return owned_.empty() || owned_[node];
  } ///< this rank counts it in sums over nodes

  void clear(double* list) { std::fill_n(list, size_, 0.0); }
  /// Does this rank see a node of that box, and another too?
  bool is_shared(const Site<Dim>& lower, const Site<Dim>& upper) const;
  /// Adds up lists of this rank and others. Collective.
  void add_up(std::span<double* const> lists);

private:
  /// Nodes that another rank sees too, as pieces of lines.
  struct Shared {
    int rank = 0;
    Site<Dim> lower{}, upper{};
    std::vector<std::size_t> first, length;
    std::size_t nodes = 0;
  };
  MPI_Comm comm_ = MPI_COMM_NULL;
  Site<Dim> lower_{}, upper_{};
  std::size_t size_ = 0;
  AlignedVector<double> numbers_;
  NodeView<Dim> view_;
  std::vector<Shared> shared_;
  std::vector<std::uint8_t> owned_;
};
} // namespace pdx::mpm
