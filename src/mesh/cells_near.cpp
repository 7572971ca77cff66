#include "pdx/mesh/cells_near.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::mesh {
namespace {
using Corners = std::array<Vector<2>, 4>;
constexpr double kBeside = 1e-6; // of a cell: as far from the box it still touches

std::vector<Corners> of_box(const MeshOptions& options, const geom::Box<2>& box)
{
  const Vector<2> h = options.box.size().array() / Eigen::Array2d(options.cells[0], options.cells[1]);
  const auto line = [&](Eigen::Index d, Index number) { return options.box.lower[d] + h[d] * number; };
  std::array<Index, 2> first{}, end{};
  for (Eigen::Index d = 0; d < 2; ++d) {
    const auto e = static_cast<std::size_t>(d);
    const auto within = [&](double x) { return std::clamp(x, 0.0, static_cast<double>(options.cells[e])); };
    first[e] = static_cast<Index>(within(std::ceil((box.lower[d] - options.box.lower[d]) / h[d] - kBeside) - 1.0));
    end[e] = static_cast<Index>(within(std::floor((box.upper[d] - options.box.lower[d]) / h[d] + kBeside) + 1.0));
  }
  std::vector<Corners> cells;
  for (Index j = first[1]; j < end[1]; ++j)
    for (Index i = first[0]; i < end[0]; ++i) {
      const double x0 = line(0, i), x1 = line(0, i + 1), y0 = line(1, j), y1 = line(1, j + 1);
      cells.push_back({Vector<2>(x0, y0), Vector<2>(x1, y0), Vector<2>(x1, y1), Vector<2>(x0, y1)});
    }
  return cells;
}

std::vector<std::array<double, 8>> of_list(const CellList& list, const geom::Box<2>& box)
{
  std::vector<std::array<double, 8>> cells;
  for (const std::array<Index, 4>& cell : list.cells) {
    std::array<double, 8> x{};
    Vector<2> lower = list.points[static_cast<std::size_t>(cell[0])], upper = lower;
    for (std::size_t k = 0; k < 4; ++k) {
      const Vector<2>& point = list.points[static_cast<std::size_t>(cell[k])];
      x[2 * k] = point[0];
      x[2 * k + 1] = point[1];
      lower = lower.cwiseMin(point);
      upper = upper.cwiseMax(point);
    }
    const double near = kBeside * (upper - lower).minCoeff();
    if ((lower.array() <= box.upper.array() + near).all() && (upper.array() >= box.lower.array() - near).all())
      cells.push_back(x);
  }
  return cells;
}
} // namespace

std::vector<std::array<Vector<2>, 4>> cells_near(MPI_Comm comm, const MeshOptions& options, const geom::Box<2>& box)
{
  if (options.file.empty()) return of_box(options, box);
  const auto found = gather_all(comm, of_list(*options.list, box)); // rank 0 has them
  std::vector<Corners> cells;
  for (const std::array<double, 8>& x : found)
    cells.push_back({Vector<2>(x[0], x[1]), Vector<2>(x[2], x[3]), Vector<2>(x[4], x[5]), Vector<2>(x[6], x[7])});
  return cells;
}
} // namespace pdx::mesh
