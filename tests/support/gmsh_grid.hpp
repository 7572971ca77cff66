#pragma once
#include "pdx/mesh/build.hpp"
#include "support/scratch_directory.hpp"

#include <cmath>
#include <fstream>
#include <functional>

namespace pdx::test {
/// A box of cells whose nodes are moved before they are written.
struct Grid {
  geom::Box<2> box;           ///< [m]
  std::array<Index, 2> cells; ///< per direction
  /// Where a node goes [m]; nodes on the sides must stay on them. Empty: nowhere.
  std::function<Vector<2>(const Vector<2>& x)> moved;
};

/// Moves inner nodes of a grid by up to `share` of a cell, alternately, so that no refinement makes cells
/// parallelograms.
inline std::function<Vector<2>(const Vector<2>&)> zigzag(const geom::Box<2>& box, std::array<Index, 2> cells,
                                                         double share)
{
  return [=](const Vector<2>& x) {
    const Vector<2> h = box.size().cwiseQuotient(Vector<2>(cells[0], cells[1]));
    const Vector<2> at = (x - box.lower).cwiseQuotient(h);
    const long i = std::lround(at.x()), j = std::lround(at.y());
    if (i == 0 || j == 0 || i == cells[0] || j == cells[1]) return x;
    return Vector<2>(x.x() + (j % 2 ? share : -share) * h.x(), x.y() + (i % 2 ? share : -share) * h.y());
  };
}

/// Writes the grid as Gmsh 2.2 text with boundaries left, right, bottom and top.
inline void write_gmsh(const std::string& path, const Grid& grid)
{
  std::ofstream file(path);
  file.precision(17);
  const Index nx = grid.cells[0], ny = grid.cells[1];
  const auto node = [nx](Index i, Index j) { return 1 + i + j * (nx + 1); };
  file << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"left\"\n1 2 \"right\"\n1 3 \"bottom\"\n"
       << "1 4 \"top\"\n2 5 \"plate\"\n$EndPhysicalNames\n$Nodes\n"
       << (nx + 1) * (ny + 1) << "\n";
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i) {
      Vector<2> x = grid.box.lower + grid.box.size().cwiseProduct(Vector<2>(double(i) / nx, double(j) / ny));
      if (grid.moved) x = grid.moved(x);
      file << node(i, j) << ' ' << x.x() << ' ' << x.y() << " 0\n";
    }
  file << "$EndNodes\n$Elements\n" << nx * ny + 2 * (nx + ny) << "\n";
  Index id = 0;
  const auto line = [&](int group, Index a, Index b) {
    file << ++id << " 1 2 " << group << ' ' << group << ' ' << a << ' ' << b << "\n";
  };
  for (Index j = 0; j < ny; ++j) line(1, node(0, j + 1), node(0, j)), line(2, node(nx, j), node(nx, j + 1));
  for (Index i = 0; i < nx; ++i) line(3, node(i, 0), node(i + 1, 0)), line(4, node(i + 1, ny), node(i, ny));
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i)
      file << ++id << " 3 2 5 5 " << node(i, j) << ' ' << node(i + 1, j) << ' ' << node(i + 1, j + 1) << ' '
           << node(i, j + 1) << "\n";
  file << "$EndElements\n";
}

/// The grid as a distributed mesh: a box mesh if no node is moved, else by way of a Gmsh file. Collective.
inline mesh::Mesh grid_mesh(MPI_Comm comm, const Grid& grid)
{
  const auto even = [](const std::array<Vector<2>, 4>&) { return 1; };
  mesh::MeshOptions options;
  if (!grid.moved) {
    options.box = grid.box;
    options.cells = grid.cells;
    return mesh::build(comm, options, even);
  }
  const ScratchDirectory scratch(comm);
  options.file = (scratch.path() / "grid.msh").string();
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank == 0) write_gmsh(options.file, grid);
  MPI_Barrier(comm);
  return mesh::build(comm, options, even);
}
} // namespace pdx::test
