#include "pdx/couple/patch_shape.hpp"

#include <algorithm>

namespace pdx::couple {
PatchShape PatchShape::of_box(const geom::Box<2>& box, const geom::Lattice<2>& lattice)
{
  return {box, lattice, geom::SiteSet<2>(lattice), {box}, {}};
}

bool PatchShape::holds(const Vector<2>& x, double margin) const
{
  return std::ranges::any_of(boxes, [&](const geom::Box<2>& each) { return each.contains(x, margin); });
}

double PatchShape::line(std::size_t axis, Index k) const
{
  const auto d = static_cast<Eigen::Index>(axis);
  if (k == lattice.count[axis]) return box.upper[d];
  return k == 0 ? box.lower[d] : box.lower[d] + k * lattice.dx;
}
} // namespace pdx::couple
