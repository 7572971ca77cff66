#pragma once
#include "pdx/base/tensor.hpp"

#include <string>
#include <vector>

namespace pdx::mesh {
/// Four-node cells as a file or a program gives them.
struct CellList {
  struct Edge {
    std::array<Index, 2> vertices;
    Index name; ///< position in `boundaries`
  };
  std::vector<Vector<2>> points;           ///< all of them used [m]
  std::vector<std::array<Index, 4>> cells; ///< counter-clockwise, convex
  std::vector<std::string> boundaries;     ///< names
  std::vector<Edge> edges;                 ///< of the outer boundary; one entry for every name an edge has
  std::vector<int> costs;                  ///< of cells, above 0; none: as who builds the mesh says
};

/// Reads a Gmsh file (2.2 or 4.1, text or binary) of four-node cells in a plane z = constant. Physical curves name the
/// boundaries; edges of the outer boundary without a named curve go to "unnamed". Clockwise cells are turned. Not
/// collective. Throws UserError for anything else, in one line that begins with "-mesh_file FILE".
CellList read_gmsh(const std::string& file);

/// Border of a region of a Gmsh file, edge by edge: of the cells of three or four nodes in a physical surface, or of
/// all cells. Not collective. Throws UserError, in one line that begins with the option.
/// @param option by which the user named the file   @param region name of the surface; empty: all
std::vector<std::array<Vector<2>, 2>> read_gmsh_border(const std::string& option, const std::string& file,
                                                       const std::string& region);
} // namespace pdx::mesh
