#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/mesh/mesh.hpp"

namespace pdx::scene {
/// Cells whose use a change of layout may have changed, with the use they had.
class TouchedCells {
public:
  void note(Index cell, mesh::Use before) { cells_.emplace_back(cell, before); } ///< of a cell the first note counts
  std::vector<Index> all() const;                                                ///< ascending
  std::vector<Index> changed(const mesh::Mesh& mesh) const; ///< those that have another use now, ascending

private:
  std::vector<std::pair<Index, mesh::Use>> first_notes() const;
  std::vector<std::pair<Index, mesh::Use>> cells_;
};

/// Does a crack come as near to one of the cells as two of its longest sides?
bool near_cracks(const mesh::Mesh& mesh, std::span<const Index> cells, const crack::CrackSet& cracks);

/// Local vertices of some cells, ascending.
std::vector<Index> vertices_of(const mesh::Mesh& mesh, std::span<const Index> cells);

/// Rows in ranges. @param rows ascending, each once
std::vector<std::array<Index, 2>> ranges_of(std::span<const Index> rows);
} // namespace pdx::scene
