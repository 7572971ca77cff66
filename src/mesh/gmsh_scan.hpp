#pragma once
#include "gmsh_source.hpp"
#include "pdx/base/tensor.hpp"

#include <map>
#include <vector>

namespace pdx::mesh {
/// What a Gmsh file says of a mesh of four-node cells.
struct GmshFile {
  struct Node {
    std::int64_t tag; ///< its number in the file
    Vector<3> x;      ///< [m]
  };
  struct Cell {
    std::array<std::size_t, 4> nodes; ///< places in `nodes`
    std::size_t place;                ///< in the file
    std::int64_t entity, group;       ///< elementary and physical tag; 4.1: no group here
  };
  /// A line in a physical curve; one entry for each curve it is in.
  struct Line {
    std::array<std::size_t, 2> ends; ///< places in `nodes`
    std::int64_t group;              ///< physical tag
  };
  std::vector<Node> nodes; ///< ascending tags
  std::vector<Cell> cells;
  std::vector<Line> lines;
  std::map<std::int64_t, std::string> curve_names; ///< by physical tag
};

/// Reads the sections of a file, 2.2 or 4.1, text or binary; what says nothing of cells, nodes and physical curves is
/// passed over. Throws UserError for what cannot be a mesh of four-node cells.
GmshFile scan_gmsh(GmshSource& source);
} // namespace pdx::mesh
