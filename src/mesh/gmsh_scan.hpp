#pragma once
#include "gmsh_source.hpp"
#include "pdx/base/tensor.hpp"

#include <map>
#include <set>
#include <vector>

namespace pdx::mesh {
/// What a Gmsh file says of a mesh of four-node cells, or of those of three nodes too.
struct GmshFile {
  struct Node {
    std::int64_t tag; ///< its number in the file
    Vector<3> x;      ///< [m]
  };
  struct Cell {
    std::array<std::size_t, 4> nodes; ///< places in `nodes`; of three the last stands there twice
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
  std::map<std::int64_t, std::string> curve_names, surface_names; ///< by physical tag
  std::map<std::int64_t, std::set<std::int64_t>> surface_groups;  ///< 4.1: physical tags by elementary tag

  /// Is a cell in a physical surface?
  bool is_in(const Cell& cell, std::int64_t surface) const
  {
    const auto groups = surface_groups.find(cell.entity);
    return cell.group == surface || (groups != surface_groups.end() && groups->second.contains(surface));
  }
};

/// What kinds of cells a file may have.
enum class GmshCells { quadrilaterals, any };

/// Reads the sections of a file, 2.2 or 4.1, text or binary; what says nothing of cells, nodes and physical groups is
/// passed over. Throws UserError for what cannot be a mesh of such cells.
GmshFile scan_gmsh(GmshSource& source, GmshCells cells = GmshCells::quadrilaterals);
} // namespace pdx::mesh
