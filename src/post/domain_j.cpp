#include "pdx/post/domain_j.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/fem/elastic_kernel.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::post {
namespace {
/// q of the four corners.
Eigen::Vector4d weights(const fem::Corners& corners, const Vector<2>& tip, const DomainRing& ring)
{
  Eigen::Vector4d q;
  for (std::size_t a = 0; a < 4; ++a) {
    const double distance = (corners[a] - tip).lpNorm<Eigen::Infinity>();
    q[static_cast<Eigen::Index>(a)] = std::clamp((ring.outer - distance) / (ring.outer - ring.inner), 0.0, 1.0);
  }
  return q;
}

fem::ElementVector corner_values(const mesh::Mesh& mesh, Index cell, std::span<const double> u)
{
  fem::ElementVector values;
  for (std::size_t a = 0; a < 4; ++a)
    for (std::size_t d = 0; d < 2; ++d)
      values[static_cast<Eigen::Index>(2 * a + d)] = u[2 * static_cast<std::size_t>(mesh.cell(cell)[a]) + d];
  return values;
}

/// The integrand at a point [J/m^3].
double integrand(const fem::ElasticBody& body, const fem::Gradients& gradients, const fem::ElementVector& values,
                 const Eigen::Vector4d& q, const Vector<2>& direction)
{
  const fem::PointStrain p = fem::point_strain(gradients, values, body.kinematics);
  const Eigen::Vector3d s = body.law.stiffness() * p.strain;
  const Tensor<2> piola = p.deformation * Tensor<2>{{s[0], s[2]}, {s[2], s[1]}};
  const Tensor<2> slope = Eigen::Map<const fem::Gradients>(values.data()) * gradients.transpose();
  const Vector<2> grad_q = gradients * q;
  return (slope * direction).dot(piola * grad_q) - 0.5 * p.strain.dot(s) * grad_q.dot(direction);
}

/// Throws alike on every rank unless the ring is made of elements.
void judge(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring)
{
  const std::string place = fmt::format("the J domain from {:g} to {:g} m around the tip at {}", ring.inner, ring.outer,
                                        ring.frame.text(tip.at));
  if (!(ring.inner > 0.0 && ring.inner < ring.outer))
    throw UserError(place + " is empty: the outer half-width must be larger than the inner one");
  const geom::Box<2>& bounds = body.mesh.bounds();
  const double room = std::min((tip.at - bounds.lower).minCoeff(), (bounds.upper - tip.at).minCoeff());
  if (room < ring.outer)
    throw UserError(fmt::format("{} leaves the body; its outer half-width can be {:g} m at most", place, room));
  bool covered = false;
  for (const Index c : body.mesh.cells(mesh::Use::covered)) {
    const Eigen::Vector4d q = weights(body.mesh.corners(c), tip.at, ring);
    covered |= q.minCoeff() < 1.0 && q.maxCoeff() > 0.0;
  }
  if (any_rank(body.mesh.comm(), covered))
    throw UserError(place +
                    " holds cells under a peridynamic patch: choose an inner half-width that takes in the whole "
                    "patch, or an outer one that stays clear of it");
}
} // namespace

double domain_j(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring, std::span<const double> u,
                const CellParts& parts)
{
  static Event event("post_domain_j");
  Timed timed(event);
  judge(body, tip, ring);
  double j = 0.0;
  const auto count = [&](mesh::Use use, auto&& integral) {
    for (const Index c : body.mesh.cells(use)) {
      if (c >= body.mesh.owned_cells()) continue;
      const Eigen::Vector4d q = weights(body.mesh.corners(c), tip.at, ring);
      if (q.minCoeff() < 1.0 && q.maxCoeff() > 0.0) j += integral(c, q);
    }
  };
  count(mesh::Use::plain, [&](Index c, const Eigen::Vector4d& q) {
    const fem::Corners corners = body.mesh.corners(c);
    const fem::ElementVector values = corner_values(body.mesh, c, u);
    double sum = 0.0;
    for (const fem::QuadraturePoint& at : fem::gauss_rule(corners))
      sum += at.area * integrand(body, at.gradients, values, q, tip.direction);
    return sum;
  });
  std::vector<PartOfCell> of_cell;
  count(mesh::Use::cut, [&](Index c, const Eigen::Vector4d& q) {
    of_cell.clear();
    parts(c, of_cell);
    double sum = 0.0;
    for (const PartOfCell& part : of_cell)
      for (const xfem::PartPoint& at : part.points)
        sum += at.area * integrand(body, at.gradients, part.corner_values, q, tip.direction);
    return sum;
  });
  MPI_Allreduce(MPI_IN_PLACE, &j, 1, MPI_DOUBLE, MPI_SUM, body.mesh.comm());
  return j;
}
} // namespace pdx::post
