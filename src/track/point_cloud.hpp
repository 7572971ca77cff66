#pragma once
#include "lattice_units.hpp"

namespace pdx::track {
/// Sums for a straight line through weighted points, in spacings.
struct PointCloud {
  void add(const Vector<2>& x, double w)
  {
    weight += w;
    first += w * x;
    second += w * x * x.transpose();
  }
  /// Total least squares: along the longer axis of the cloud, with the sense of `heading`.
  Line line(const Vector<2>& heading) const
  {
    const Vector<2> middle = first / weight;
    const Tensor<2> spread = second / weight - middle * middle.transpose();
    const double angle = 0.5 * std::atan2(2.0 * spread(0, 1), spread(0, 0) - spread(1, 1));
    const Vector<2> along(std::cos(angle), std::sin(angle));
    return {middle, along.dot(heading) < 0.0 ? Vector<2>(-along) : along};
  }
  double weight = 0.0;
  Vector<2> first = Vector<2>::Zero();
  Tensor<2> second = Tensor<2>::Zero();
};
} // namespace pdx::track
