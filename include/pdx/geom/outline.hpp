#pragma once
#include "pdx/geom/box.hpp"

#include <vector>

namespace pdx::geom {
/// What edges enclose: any number of closed lines, one in another for a hole. A place on the border belongs to one of
/// two outlines that meet there, so that they neither overlap nor leave a gap.
class Outline {
public:
  using Edge = std::array<Vector<2>, 2>; ///< in either direction [m]

  Outline() = default; ///< of nothing
  explicit Outline(std::vector<Edge> edges);
  static std::vector<Edge> edges_of(const Box<2>& box);

  /// Does a ray along x from the place cross the border an odd number of times?
  bool holds(const Vector<2>& x) const;
  const Box<2>& box() const { return box_; } ///< around all edges [m]

private:
  std::size_t row_of(double y) const;

  std::vector<Edge> edges_;
  Box<2> box_;
  double rows_per_length_ = 0.0;           // [1/m]
  std::vector<std::vector<Index>> in_row_; // edges that reach into each of some equal rows of the box
};
} // namespace pdx::geom
