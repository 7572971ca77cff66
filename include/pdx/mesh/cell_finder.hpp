#pragma once
#include "pdx/geom/box.hpp"

#include <span>
#include <vector>

namespace pdx::mesh {
/// Which cells are at a vertex, and which have their middle in a box, in time that does not grow with the mesh.
class CellFinder {
public:
  /// @param cells vertices of each   @param points of the vertices [m]
  CellFinder(std::span<const std::array<Index, 4>> cells, std::span<const Vector<2>> points);

  std::span<const Index> at(Index vertex) const; ///< ascending
  /// Cells whose middle lies in the box or on its border, ascending.
  std::vector<Index> in(const geom::Box<2>& box) const;
  /// All cells that have a point in one of the boxes, and others near them, ascending.
  std::vector<Index> around(std::span<const geom::Box<2>> boxes) const;
  std::vector<Index> at_any(std::span<const Index> vertices) const; ///< cells at some vertices, ascending

private:
  std::array<Index, 2> bin_of(const Vector<2>& x) const;
  std::size_t number(Index i, Index j) const { return static_cast<std::size_t>(j * bins_[0] + i); }

  std::vector<Vector<2>> middles_;
  double reach_ = 0.0;               // of the largest cell, from its middle along an axis [m]
  std::vector<Index> first_at_, at_; // by vertex
  Vector<2> origin_{0.0, 0.0};
  double side_ = 1.0; // of a bin [m]
  std::array<Index, 2> bins_{1, 1};
  std::vector<Index> first_in_, in_; // by bin
};
} // namespace pdx::mesh
