#include "pdx/scene/body_overlap.hpp"

#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pdx::scene {
namespace body_overlap {
constexpr double kApart = 1.0 - 1e-8; // of the distance at which points touch
constexpr double kWellInside = 0.499; // of a spacing from a point: well within its square

/// The point of a body in whose square or cube a place lies, if it is nearer than so many spacings.
template <int Dim> bool holds(const mpm::Body<Dim>& body, const Vector<Dim>& x, double spacings)
{
  Site<Dim> site{};
  double square = 0.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    const double at = (x - body.corner)[static_cast<Eigen::Index>(d)] / body.material.spacing, whole = std::floor(at);
    if (!(at >= 0.0) || whole > std::numeric_limits<Index>::max() / 2.0) return false;
    site[d] = static_cast<Index>(whole);
    square += (at - whole - 0.5) * (at - whole - 0.5);
  }
  return square < spacings * spacings && body.has(site);
}

template <int Dim> bool meet(const geom::Box<Dim>& a, const geom::Box<Dim>& b)
{
  return (a.lower.array() < b.upper.array()).all() && (b.lower.array() < a.upper.array()).all();
}

template <int Dim>
[[noreturn]] void refuse(const std::string& a, const std::string& b, const Vector<Dim>& place, const geom::Frame& frame)
{
  const Vector<Dim> x = frame.given(place);
  throw UserError(fmt::format("bodies {} and {} overlap at the start: the point of {} at ({:.6g}) lies in {}; move the "
                              "bodies apart",
                              a, b, a, fmt::join(x.data(), x.data() + Dim, ", "), b));
}

bool inside(const std::array<Vector<2>, 4>& corners, const Vector<2>& x)
{
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector<2> along = corners[(k + 1) % 4] - corners[k], to = x - corners[k];
    if (!(along[0] * to[1] - along[1] * to[0] > 0.0)) return false;
  }
  return true;
}

/// Calls visit(place of a point) for the points of a body around whose centres lies a box.
template <class Visit> void for_each_near(const mpm::Body<2>& body, const geom::Box<2>& box, Visit&& visit)
{
  const double dx = body.material.spacing;
  Site<2> first{}, last{};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto a = static_cast<Eigen::Index>(d);
    const double count = static_cast<double>(body.cells[d]) * body.material.ratio;
    const double from = (box.lower[a] - body.corner[a]) / dx, to = (box.upper[a] - body.corner[a]) / dx;
    if (!(from < count && to > 0.0)) return;
    first[d] = static_cast<Index>(std::floor(std::max(from, 0.0)));
    last[d] = static_cast<Index>(std::floor(std::min(to, count - 1.0)));
  }
  for (Index j = first[1]; j <= last[1]; ++j)
    for (Index i = first[0]; i <= last[0]; ++i)
      if (body.has({i, j})) visit(Vector<2>(body.corner + dx * Vector<2>(i + 0.5, j + 0.5)));
}
} // namespace body_overlap

template <int Dim> void refuse_overlap(const PointPlan<Dim>& plan, const geom::Frame& frame)
{
  using namespace body_overlap;
  std::vector<geom::Box<Dim>> boxes;
  for (const mpm::Body<Dim>& body : plan.bodies) boxes.push_back(body.around());
  for (std::size_t a = 0; a < plan.bodies.size(); ++a)
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
      const mpm::Body<Dim>&of = plan.bodies[a], &other = plan.bodies[b];
      if (a == b || !meet(boxes[a], boxes[b])) continue;
      const double touch = kApart * 0.5 * (of.material.spacing / other.material.spacing + 1.0);
      of.for_each_place([&](const Vector<Dim>& x) {
        if (holds(other, x, touch)) refuse(of.name, other.name, x, frame);
      });
    }
}

void refuse_overlap(MPI_Comm comm, const PointPlan<2>& plan, const geom::Frame& frame)
{
  using namespace body_overlap;
  std::array<double, 3> found{-1.0, 0.0, 0.0}; // body, place
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  for (Index c = 0; rank == 0 && c < plan.first_cell && found[0] < 0.0; ++c) {
    const mesh::CellList& list = *plan.mesh.list;
    std::array<Vector<2>, 4> corners;
    std::ranges::transform(list.cells[static_cast<std::size_t>(c)], corners.begin(),
                           [&](Index v) { return list.points[static_cast<std::size_t>(v)]; });
    geom::Box<2> box{corners[0], corners[0]};
    for (const Vector<2>& x : corners) box = {box.lower.cwiseMin(x), box.upper.cwiseMax(x)};
    for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
      const auto note = [&](const Vector<2>& x) { found = {static_cast<double>(b), x[0], x[1]}; };
      for_each_near(plan.bodies[b], box, [&](const Vector<2>& x) {
        if (inside(corners, x)) note(x);
      });
      for (const Vector<2>& x : corners)
        if (holds(plan.bodies[b], x, kWellInside)) note(x);
    }
  }
  MPI_Bcast(found.data(), 3, MPI_DOUBLE, 0, comm);
  if (found[0] >= 0.0)
    refuse(plan.bodies[static_cast<std::size_t>(found[0])].name, std::string(options::kMeshBody),
           Vector<2>(found[1], found[2]), frame);
}

template void refuse_overlap<2>(const PointPlan<2>&, const geom::Frame&);
template void refuse_overlap<3>(const PointPlan<3>&, const geom::Frame&);
} // namespace pdx::scene
