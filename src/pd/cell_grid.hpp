#pragma once
#include "pdx/base/tensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace pdx::pd {
/// Points sorted into cubes, to find those near a point among 3^Dim cubes.
template <int Dim> class CellGrid {
public:
  CellGrid(const std::vector<Vector<Dim>>& points, double side) : side_(side)
  {
    lower_ = points.front();
    Vector<Dim> upper = points.front();
    for (const Vector<Dim>& x : points) {
      lower_ = lower_.cwiseMin(x).eval();
      upper = upper.cwiseMax(x).eval();
    }
    std::size_t cells = 1;
    double budget = 4.0 * static_cast<double>(points.size()) + 64.0; // cubes; wider ones where the cloud is thin
    for (double total = 1.0;; side_ *= 1.5, total = 1.0) {
      for (int d = 0; d < Dim; ++d) total *= std::floor((upper[d] - lower_[d]) / side_) + 1.0;
      if (total <= budget) break;
    }
    for (int d = 0; d < Dim; ++d) {
      count_[d] = static_cast<Index>((upper[d] - lower_[d]) / side_) + 1;
      cells *= static_cast<std::size_t>(count_[d]);
    }
    first_.assign(cells + 1, 0);
    for (const Vector<Dim>& x : points) ++first_[number(cell(x)) + 1];
    for (std::size_t c = 0; c < cells; ++c) first_[c + 1] += first_[c];
    order_.resize(points.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t k = 0; k < points.size(); ++k) order_[next[number(cell(points[k]))]++] = static_cast<Index>(k);
  }

  /// All points less than a cube's side away from x, and others, in ascending order. x may lie anywhere.
  void near(const Vector<Dim>& x, std::vector<Index>& found) const
  {
    found.clear();
    const Site<Dim> centre = cell(x);
    constexpr int cubes = Dim == 2 ? 9 : 27;
    for (int cube = 0; cube < cubes; ++cube) {
      Site<Dim> at = centre;
      bool inside = true;
      for (std::size_t d = 0, digits = static_cast<std::size_t>(cube); d < Dim; ++d, digits /= 3) {
        at[d] += static_cast<Index>(digits % 3) - 1;
        inside &= at[d] >= 0 && at[d] < count_[d];
      }
      if (!inside) continue;
      const auto begin = order_.begin();
      found.insert(found.end(), begin + static_cast<std::ptrdiff_t>(first_[number(at)]),
                   begin + static_cast<std::ptrdiff_t>(first_[number(at) + 1]));
    }
    std::sort(found.begin(), found.end());
  }

private:
  Site<Dim> cell(const Vector<Dim>& x) const
  {
    Site<Dim> at{};
    for (int d = 0; d < Dim; ++d)
      at[static_cast<std::size_t>(d)] =
          static_cast<Index>(std::clamp((x[d] - lower_[d]) / side_, 0.0, count_[static_cast<std::size_t>(d)] - 1.0));
    return at;
  }
  std::size_t number(const Site<Dim>& at) const
  {
    std::size_t n = 0;
    for (std::size_t d = Dim; d-- > 0;) n = n * static_cast<std::size_t>(count_[d]) + static_cast<std::size_t>(at[d]);
    return n;
  }

  double side_;
  Vector<Dim> lower_;
  Site<Dim> count_{};
  std::vector<std::size_t> first_;
  std::vector<Index> order_;
};
} // namespace pdx::pd
