#include "pdx/scene/point_shapes.hpp"

#include "point_skins.hpp"

#include "pdx/base/error.hpp"
#include "pdx/pd/cloud.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <set>
#include <unordered_map>

namespace pdx::scene {
namespace {
constexpr double kFits = 1e-6;   // of a spacing
constexpr double kOnSite = 1e-3; // likewise, of what a file says
constexpr double kVolume = 1e-2; // of that of a site
constexpr double kOnRim = 1e-9;  // of a radius: what is as far outside is on the border

template <int Dim> geom::Box<Dim> in_dimensions(const geom::Box<3>& box)
{
  return {box.lower.head<Dim>(), box.upper.head<Dim>()};
}

/// The spacing near to dx of which one side is a whole number.
double near_fit(double side, double dx) { return side / std::max(1.0, std::round(side / dx)); }

void require_fit(const options::PointBodyOptions& body, double side, const char* what)
{
  const double count = side / body.spacing;
  if (std::abs(count - std::round(count)) <= kFits * std::max(1.0, count) && std::round(count) >= 1.0) return;
  throw UserError(fmt::format("-mpm_{}: {} is {:.10g} m, no whole number of the spacing of {:g} m; the nearest that "
                              "fits it is {:.10g}",
                              body.name, what, side, body.spacing, near_fit(side, body.spacing)));
}

/// Boxes fit the lattice, so that their sides are where they are said to be.
template <int Dim> mpm::Body<Dim> box_body(const options::PointBodyOptions& body, const mpm::BodyMaterial& material)
{
  static constexpr const char* sides[] = {"the side along x", "the side along y", "the side along z"};
  const geom::Box<Dim> box = in_dimensions<Dim>(*body.shape.box);
  for (int d = 0; d < Dim; ++d) require_fit(body, box.size()[d], sides[d]);
  return mpm::fill_body<Dim>(body.name, material, box, [&box](const Vector<Dim>& x) { return box.contains(x, 0.0); });
}

/// Round bodies have their centre on a node of the grid: their points mirror.
template <int Dim>
mpm::Body<Dim> round_body(const options::PointBodyOptions& body, const mpm::BodyMaterial& material,
                          const options::PointShape::Ball& ball, int round)
{
  const double h = material.ratio * material.spacing, reach = h * std::max(1.0, std::ceil(ball.radius / h - kFits));
  geom::Box<3> box{ball.centre.array() - reach, ball.centre.array() + reach};
  if (round == 2 && Dim == 3) {
    box.lower[2] = body.shape.z_lower;
    box.upper[2] = body.shape.z_upper;
    require_fit(body, box.size()[2], "the depth");
  }
  const double limit = ball.radius * ball.radius * (1.0 + kOnRim);
  return mpm::fill_body<Dim>(body.name, material, in_dimensions<Dim>(box), [&](const Vector<Dim>& x) {
    double square = 0.0;
    for (int d = 0; d < std::min(round, Dim); ++d) square += (x[d] - ball.centre[d]) * (x[d] - ball.centre[d]);
    return square <= limit && (round == Dim || x[Dim - 1] < box.upper[2]);
  });
}

/// What a border of edges encloses, row by row: edges that cross a row are looked for once.
class Enclosed {
public:
  explicit Enclosed(const std::vector<std::array<Vector<2>, 2>>& border) : border_(border) {}

  /// Does a ray along x from the point cross the border an odd number of times?
  bool operator()(const Vector<2>& x)
  {
    const auto [row, fresh] = crossings_.try_emplace(x[1]);
    if (fresh) find(x[1], row->second);
    return (row->second.end() - std::ranges::upper_bound(row->second, x[0])) % 2 != 0;
  }

private:
  void find(double y, std::vector<double>& at) const
  {
    for (const auto& [a, b] : border_)
      if ((a[1] > y) != (b[1] > y)) at.push_back(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    std::ranges::sort(at);
  }

  const std::vector<std::array<Vector<2>, 2>>& border_;
  std::unordered_map<double, std::vector<double>> crossings_; // places along x, ascending, by y [m]
};

template <int Dim>
mpm::Body<Dim> enclosed_body(const options::PointBodyOptions& body, const mpm::BodyMaterial& material)
{
  const geom::Box<3> box = body.shape.around();
  if (Dim == 3) require_fit(body, box.size()[2], "the depth");
  Enclosed inside(body.shape.border);
  return mpm::fill_body<Dim>(body.name, material, in_dimensions<Dim>(box), [&](const Vector<Dim>& x) {
    return inside(x.template head<2>()) && (Dim == 2 || x[Dim - 1] < box.upper[2]);
  });
}

template <int Dim> pd::Cloud<Dim> read_points(const options::PointBodyOptions& body)
{
  try {
    pd::Cloud<Dim> cloud = pd::read_cloud<Dim>(body.shape.file);
    for (Vector<Dim>& x : cloud.points) x += body.shape.file_moved.template head<Dim>();
    return cloud;
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-mpm_{}_file: {}", body.name, wrong.what()));
  }
}

/// All points of a file lie on sites, each on its own.
template <int Dim>
mpm::Body<Dim> file_body(const options::PointBodyOptions& body, const mpm::BodyMaterial& material,
                         const geom::Frame& frame)
{
  const pd::Cloud<Dim> cloud = read_points<Dim>(body);
  const double dx = material.spacing, volume = Dim == 2 ? dx * dx * body.elastic.thickness : dx * dx * dx;
  const geom::Box<3> around = around_file<Dim>(body);
  const geom::Box<Dim> box{frame.inside(Vector<3>(around.lower)).template head<Dim>(),
                           frame.inside(Vector<3>(around.upper)).template head<Dim>()};
  std::set<Site<Dim>> sites;
  for (std::size_t k = 0; k < cloud.points.size(); ++k) {
    const Vector<Dim> at = (frame.inside(cloud.points[k]) - box.lower) / dx;
    Site<Dim> site{};
    bool on = std::abs(cloud.volumes[k] / volume - 1.0) <= kVolume;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double place = at[static_cast<Eigen::Index>(d)];
      site[d] = static_cast<Index>(std::floor(place));
      on = on && std::abs(place - (site[d] + 0.5)) <= kOnSite;
    }
    if (!on || !sites.insert(site).second)
      throw UserError(fmt::format("-mpm_{}_file: point {} lies on no free site of a lattice of {:g} m, or has another "
                                  "volume than the {:g} m^3 of a site",
                                  body.name, k + 1, dx, volume));
  }
  return mpm::fill_body<Dim>(body.name, material, box, [&](const Vector<Dim>& x) {
    Site<Dim> site{};
    for (std::size_t d = 0; d < Dim; ++d)
      site[d] = static_cast<Index>(std::floor((x - box.lower)[static_cast<Eigen::Index>(d)] / dx));
    return sites.contains(site);
  });
}
} // namespace

template <int Dim> geom::Box<3> around_file(const options::PointBodyOptions& options)
{
  constexpr double far = std::numeric_limits<double>::max();
  Vector<Dim> lower = Vector<Dim>::Constant(far), upper = Vector<Dim>::Constant(-far);
  for (const Vector<Dim>& x : read_points<Dim>(options).points) {
    lower = lower.cwiseMin(x).eval();
    upper = upper.cwiseMax(x).eval();
  }
  geom::Box<3> box;
  box.lower.template head<Dim>() = lower.array() - 0.5 * options.spacing;
  box.upper.template head<Dim>() = upper.array() + 0.5 * options.spacing;
  return box;
}

namespace {
template <int Dim>
mpm::Body<Dim> whole_body(const options::PointBodyOptions& options, const mpm::BodyMaterial& material,
                          const geom::Frame& frame)
{
  const options::PointShape& shape = options.shape;
  if (shape.box) return box_body<Dim>(options, material);
  if (shape.disc) return round_body<Dim>(options, material, *shape.disc, 2);
  if (shape.sphere) return round_body<Dim>(options, material, *shape.sphere, 3);
  if (!shape.border.empty()) return enclosed_body<Dim>(options, material);
  return file_body<Dim>(options, material, frame);
}
} // namespace

template <int Dim>
mpm::Body<Dim> body_of(const options::PointBodyOptions& options, const mpm::BodyMaterial& material,
                       const geom::Frame& frame)
{
  mpm::Body<Dim> body = whole_body<Dim>(options, material, frame);
  body.skin = skin_of<Dim>(options.shape, material.spacing, [shape = options.shape](const Vector<2>& x) {
    Enclosed inside(shape.border);
    return inside(x);
  });
  const std::vector<options::PointShape::Ball>& holes = options.shape.holes;
  if (holes.empty()) return body;
  if (body.skin)
    body.skin = [skin = std::move(body.skin), holes](const Vector<Dim>& site, unsigned uncovered) {
      const Vector<Dim> moved = skin(site, uncovered);
      const double way = (moved - site).norm();
      const bool at_hole = std::ranges::any_of(holes, [&](const options::PointShape::Ball& hole) {
        const Vector<2> away = site.template head<2>() - hole.centre.template head<2>();
        return std::abs(away.norm() - hole.radius) < way;
      });
      return at_hole ? site : moved;
    };
  for (std::size_t k = 0; k < body.points.size(); ++k) {
    const Vector<Dim> middle = body.node(body.cell(static_cast<std::int64_t>(k))).array() + 0.5 * body.cell_size();
    for (const options::PointShape::Ball& hole : holes) {
      const Vector<2> away = middle.template head<2>() - hole.centre.template head<2>();
      if (away.squaredNorm() < hole.radius * hole.radius * (1.0 - kOnRim)) body.points[k] = 0;
    }
  }
  if (body.count() == 0) throw UserError(fmt::format("-mpm_{0}_hole: nothing of {0} is left", options.name));
  return body;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template mpm::Body<Dim> body_of<Dim>(const options::PointBodyOptions&, const mpm::BodyMaterial&,                     \
                                       const geom::Frame&);                                                            \
  template geom::Box<3> around_file<Dim>(const options::PointBodyOptions&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::scene
