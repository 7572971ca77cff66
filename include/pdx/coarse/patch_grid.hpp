#pragma once
#include "pdx/couple/surroundings.hpp"
#include "pdx/pd/lattice_part.hpp"

namespace pdx::coarse {
/// A grid of rectangular cells over one patch, about as wide as a horizon or as the elements around it, whichever is
/// less: the solver's coarse picture of the patch. All straight sides of the patch run along its lines, between which
/// cells are alike; those outside the patch are not used. A node on a border with elements behind is carried by the
/// mesh edges there; all others have rows, which belong to the rank that has the particle next to them.
class PatchGrid {
public:
  /// @param part, around must outlive the grid
  PatchGrid(const pd::LatticePart<2>& part, const couple::Surroundings& around);

  Index nodes() const { return (cells_[0] + 1) * (cells_[1] + 1); }
  Index cells() const { return cells_[0] * cells_[1]; }
  bool in_patch(Index cell) const { return part_.active().has(sites(cell).first); }
  /// Cells of one kind are as large.
  std::size_t kinds() const { return axes_[0].sizes.size() * axes_[1].sizes.size(); }
  std::size_t kind(Index cell) const;
  Vector<2> size_of(std::size_t kind) const; ///< [m]
  Vector<2> point(Index node) const;         ///< [m]
  bool carried(Index node) const { return carried_[static_cast<std::size_t>(node)] != 0; }
  /// What carries the node, as seen from a particle at x: of the side of a crack on which x lies.
  couple::Host host(Index node, const Vector<2>& x) const;
  std::span<const Index> owned() const { return owned_; } ///< nodes whose rows this rank has, ascending
  std::array<Index, 4> corners(Index cell) const;         ///< nodes, counter-clockwise
  /// Cells of the patch around a node, calls visit(cell).
  template <class Visit> void for_each_cell_at(Index node, Visit&& visit) const;
  Index cell_of(const Site<2>& site) const;
  /// Sites of a cell: [lower, upper) in x and y.
  std::pair<Site<2>, Site<2>> sites(Index cell) const;
  /// Bilinear weights of the corners of a cell at x.
  std::array<double, 4> weights(Index cell, const Vector<2>& x) const;
  const pd::LatticePart<2>& part() const { return part_; }

private:
  /// The cells along one axis, in gaps between lines on which sides of the patch lie.
  struct Axis {
    std::vector<double> lines;    // [m]
    std::vector<double> sizes;    // of cells, per gap [m]
    std::vector<std::size_t> gap; // per column
    std::vector<Index> first;     // site of each column, and the end
    std::vector<Index> column;    // per site
  };
  void divide(std::size_t axis, double width);
  Site<2> particle_at(Index node) const;
  const pd::LatticePart<2>& part_;
  const couple::Surroundings& around_;
  std::array<Index, 2> cells_{};
  std::array<Axis, 2> axes_;
  std::vector<std::uint8_t> carried_;
  std::vector<Index> owned_;
};

template <class Visit> void PatchGrid::for_each_cell_at(Index node, Visit&& visit) const
{
  const Index i = node % (cells_[0] + 1), j = node / (cells_[0] + 1);
  for (Index cj = std::max<Index>(j - 1, 0); cj <= std::min(j, cells_[1] - 1); ++cj)
    for (Index ci = std::max<Index>(i - 1, 0); ci <= std::min(i, cells_[0] - 1); ++ci)
      if (const Index cell = cj * cells_[0] + ci; in_patch(cell)) visit(cell);
}
} // namespace pdx::coarse
