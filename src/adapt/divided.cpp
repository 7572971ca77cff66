#include "pdx/adapt/divided.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::adapt {
geom::Box<2> box_around(const Corners& corners)
{
  geom::Box<2> box{corners[0], corners[0]};
  for (const Vector<2>& x : corners) box = {box.lower.cwiseMin(x), box.upper.cwiseMax(x)};
  return box;
}

bool is_box(const Corners& corners, double near)
{
  const geom::Box<2> box = box_around(corners);
  return std::ranges::all_of(corners, [&](const Vector<2>& x) {
    return ((x - box.lower).cwiseAbs().cwiseMin((x - box.upper).cwiseAbs()).array() < near).all();
  });
}

bool is_divided(const Corners& corners, const geom::Lattice<2>& lattice)
{
  const auto on_line = [&](double x, double origin) {
    const double line = (x - origin) / lattice.dx;
    return std::abs(line - std::round(line)) <= kFits * std::max(1.0, std::abs(line));
  };
  return is_box(corners, kFits * lattice.dx) && std::ranges::all_of(corners, [&](const Vector<2>& x) {
           return on_line(x[0], lattice.origin[0]) && on_line(x[1], lattice.origin[1]);
         });
}
} // namespace pdx::adapt
