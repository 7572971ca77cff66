#include "pdx/options/polygon.hpp"

#include "pdx/base/error.hpp"
#include "pdx/geom/orientation.hpp"

#include <fmt/format.h>
#include <span>

namespace pdx::options {
namespace {
bool crosses(const geom::Outline::Edge& a, const geom::Outline::Edge& b)
{
  const auto side = [](const geom::Outline::Edge& of, const Vector<2>& x) {
    return geom::orientation(of[0], of[1], x);
  };
  return side(a, b[0]) * side(a, b[1]) < 0 && side(b, a[0]) * side(b, a[1]) < 0;
}

/// What lies in a polygon that crosses itself is not what one sees.
void refuse_crossing(const std::string& name, std::span<const geom::Outline::Edge> border)
{
  for (std::size_t a = 0; a < border.size(); ++a)
    for (std::size_t b = a + 1; b < border.size(); ++b)
      if (crosses(border[a], border[b]))
        throw UserError(
            fmt::format("{} crosses itself: its sides from ({:g}, {:g}) and from ({:g}, {:g}) meet; give the "
                        "corners in order",
                        name, border[a][0][0], border[a][0][1], border[b][0][0], border[b][0][1]));
}
} // namespace

std::vector<geom::Outline::Edge> read_polygon(Options& o, const std::string& name)
{
  const std::vector<double> v = o.reals(name, {}, 0, "m", "corners of a polygon in order: x0,y0,x1,y1,x2,y2,...");
  if (v.size() % 2 || (!v.empty() && v.size() < 6))
    throw UserError(fmt::format("{} has {} numbers: must be x,y of three corners or more", name, v.size()));
  std::vector<geom::Outline::Edge> border;
  for (std::size_t k = 0; k < v.size(); k += 2) {
    const std::size_t next = (k + 2) % v.size();
    border.push_back({Vector<2>(v[k], v[k + 1]), Vector<2>(v[next], v[next + 1])});
  }
  refuse_crossing(name, border);
  return border;
}
} // namespace pdx::options
