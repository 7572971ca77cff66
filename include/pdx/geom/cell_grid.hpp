#pragma once
#include "pdx/base/tensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace pdx::geom {
/// Points sorted into cubes, to find those near a point among 3^Dim cubes. Only cubes with points are kept: how far
/// apart points are costs nothing.
template <int Dim> class CellGrid {
public:
  CellGrid(const std::vector<Vector<Dim>>& points, double side) : side_(side)
  {
    order_.reserve(points.size());
    for (std::size_t k = 0; k < points.size(); ++k) order_.push_back({cube(points[k]), static_cast<Index>(k)});
    std::ranges::sort(order_, {}, [](const Entry& e) { return std::pair(e.cube, e.point); });
  }

  /// All points less than a cube's side away from x, and others, in ascending order.
  void near(const Vector<Dim>& x, std::vector<Index>& found) const
  {
    found.clear();
    const Cube centre = cube(x);
    for (int line = 0; line < (Dim == 2 ? 3 : 9); ++line) { // three neighbouring cubes of a line follow each other
      Cube first = centre;
      first[Dim - 1] -= 1;
      first[Dim - 2] += line % 3 - 1;
      if constexpr (Dim == 3) first[0] += line / 3 - 1;
      Cube last = first;
      last[Dim - 1] += 2;
      for (auto e = std::ranges::lower_bound(order_, first, {}, &Entry::cube); e != order_.end() && e->cube <= last;
           ++e)
        found.push_back(e->point);
    }
    std::ranges::sort(found);
  }

private:
  using Cube = std::array<std::int64_t, Dim>; // z, y, x
  struct Entry {
    Cube cube;
    Index point;
  };

  Cube cube(const Vector<Dim>& x) const
  {
    constexpr double far = 4e18; // of integers
    Cube at{};
    for (int d = 0; d < Dim; ++d)
      at[static_cast<std::size_t>(Dim - 1 - d)] =
          static_cast<std::int64_t>(std::clamp(std::floor(x[d] / side_), -far, far));
    return at;
  }

  double side_;
  std::vector<Entry> order_;
};
} // namespace pdx::geom
