#include "condition_sides.hpp"

#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
std::optional<BoxSide> box_side(const std::string& name, std::size_t dim)
{
  static constexpr const char* kNames[] = {"left", "right", "bottom", "top", "back", "front"};
  for (std::size_t k = 0; k < 2 * dim; ++k)
    if (name == kNames[k]) return BoxSide{k / 2, k % 2 == 1};
  return std::nullopt;
}

BoxSide point_side(const options::BoundaryCondition& c, std::size_t dim)
{
  if (const auto side = box_side(c.on, dim)) return *side;
  throw UserError(fmt::format("-bc_{}_on is {}: a body of points has left, right, bottom, top{}", c.name, c.on,
                              dim == 3 ? ", back (low z) and front" : ""));
}

void require_line(const options::BoundaryCondition& c, const std::string& body, double cells, double width)
{
  constexpr double kOnLine = 1e-6; // of a cell
  if (std::abs(cells - std::round(cells)) <= kOnLine) return;
  throw UserError(fmt::format("-bc_{0}_on is {1}: that side of {2} lies within a cell of its grid, {3:g} m wide: make "
                              "its length a whole number of cells, or choose nodes by -bc_{0}_box",
                              c.name, c.on, body, width));
}
} // namespace pdx::scene
