#pragma once
#include <string>

/// Gmsh files for tests: cells [0,1] x [0,1] and [1,2] x [0,1] at z = 0.5, the second clockwise; "left" and "right"
/// are physical curves, "plate" is the surface (with the tag of "left"); the lower edge of the first cell is a line in
/// no physical group; node 7 belongs to no cell.
namespace mesh_files {
inline std::string names()
{
  return "$PhysicalNames\n3\n1 1 \"left\"\n1 2 \"right\"\n2 1 \"plate\"\n$EndPhysicalNames\n";
}

inline std::string before_elements_22()
{
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + names() +
         "$Nodes\n7\n1 0 0 0.5\n2 1 0 0.5\n3 2 0 0.5\n4 0 1 0.5\n5 1 1 0.5\n6 2 1 0.5\n7 9 9 0.5\n$EndNodes\n";
}

inline std::string two_cells_22()
{
  return before_elements_22() + "$Elements\n6\n1 1 2 1 1 1 4\n2 1 2 2 2 3 6\n3 1 2 0 3 1 2\n4 15 2 7 7 7\n"
                                "5 3 2 1 1 1 2 5 4\n6 3 2 1 1 2 5 6 3\n$EndElements\n";
}

inline std::string without_cells_22()
{
  return before_elements_22() + "$Elements\n2\n1 1 2 1 1 1 4\n2 1 2 2 2 3 6\n$EndElements\n";
}

inline std::string two_cells_41()
{
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + names() +
         "$Entities\n1 3 1 0\n7 9 9 0.5 0\n1 0 0 0.5 0 1 0.5 1 1 0\n2 2 0 0.5 2 1 0.5 1 2 0\n3 0 0 0.5 1 0 0.5 0 0\n"
         "1 0 0 0.5 2 1 0.5 1 1 3 1 2 3\n$EndEntities\n"
         "$Nodes\n2 7 1 7\n0 7 0 1\n7\n9 9 0.5\n2 1 0 6\n1\n2\n3\n4\n5\n6\n0 0 0.5\n1 0 0.5\n2 0 0.5\n0 1 0.5\n"
         "1 1 0.5\n2 1 0.5\n$EndNodes\n"
         "$Elements\n4 5 1 5\n1 1 1 1\n1 1 4\n1 2 1 1\n2 3 6\n1 3 1 1\n3 1 2\n2 1 3 2\n4 1 2 5 4\n5 2 5 6 3\n"
         "$EndElements\n";
}

inline std::string replaced(std::string text, const std::string& part, const std::string& by)
{
  const std::size_t begin = text.find(part);
  return begin == std::string::npos ? "part not found" : text.replace(begin, part.size(), by);
}
} // namespace mesh_files
