#include "pdx/post/domain_j.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/law/fracture.hpp"
#include "pdx/post/tip_frame.hpp"

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

Vector<2> place(const fem::Corners& corners, const Eigen::Vector4d& shape)
{
  Vector<2> x = Vector<2>::Zero();
  for (std::size_t a = 0; a < 4; ++a) x += shape[static_cast<Eigen::Index>(a)] * corners[a];
  return x;
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

/// A quadrature point of the ring: of a cell whose corners move by `values` and have the weights `q`.
struct RingPoint {
  const fem::Gradients& gradients;
  const fem::ElementVector& values;
  const Eigen::Vector4d& q;
  Vector<2> at; ///< [m]
};

/// Adds area * integrand over the ring, on this rank.
template <class Integrand>
void sweep_ring(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring, std::span<const double> u,
                const CellParts& parts, Integrand&& add)
{
  const auto over = [&](mesh::Use use, auto&& cell) {
    for (const Index c : body.mesh.cells(use)) {
      if (c >= body.mesh.owned_cells()) continue;
      const Eigen::Vector4d q = weights(body.mesh.corners(c), tip.at, ring);
      if (q.minCoeff() < 1.0 && q.maxCoeff() > 0.0) cell(c, q);
    }
  };
  over(mesh::Use::plain, [&](Index c, const Eigen::Vector4d& q) {
    const fem::Corners corners = body.mesh.corners(c);
    const fem::ElementVector values = corner_values(body.mesh, c, u);
    const auto rule = fem::gauss_rule(corners);
    const fem::Gradients points = fem::gauss_points();
    for (std::size_t k = 0; k < rule.size(); ++k)
      add(rule[k].area,
          RingPoint{rule[k].gradients, values, q, place(corners, fem::shape(points.col(static_cast<int>(k))))});
  });
  std::vector<PartOfCell> of_cell;
  over(mesh::Use::cut, [&](Index c, const Eigen::Vector4d& q) {
    const fem::Corners corners = body.mesh.corners(c);
    of_cell.clear();
    parts(c, of_cell);
    for (const PartOfCell& part : of_cell)
      for (const xfem::PartPoint& at : part.points)
        add(at.area, RingPoint{at.gradients, part.corner_values, q, place(corners, at.shape)});
  });
}
} // namespace

double domain_j(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring, std::span<const double> u,
                const CellParts& parts)
{
  static Event event("post_domain_j");
  Timed timed(event);
  judge(body, tip, ring);
  double j = 0.0;
  sweep_ring(body, tip, ring, u, parts, [&](double area, const RingPoint& p) {
    j += area * integrand(body, p.gradients, p.values, p.q, tip.direction);
  });
  MPI_Allreduce(MPI_IN_PLACE, &j, 1, MPI_DOUBLE, MPI_SUM, body.mesh.comm());
  return j;
}

TipModes domain_modes(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring,
                      std::span<const double> u, const SideOfCrack& side, const CellParts& parts)
{
  static Event event("post_domain_modes");
  Timed timed(event);
  judge(body, tip, ring);
  const Eigen::Matrix3d stiffness = body.law.stiffness();
  const auto stress_of = [&stiffness](const Tensor<2>& h) {
    const Eigen::Vector3d s = stiffness * Eigen::Vector3d(h(0, 0), h(1, 1), h(0, 1) + h(1, 0));
    return Tensor<2>{{s[0], s[2]}, {s[2], s[1]}};
  };
  double sums[3] = {0.0, 0.0, 0.0};
  const TipFrame frame(tip);
  sweep_ring(body, tip, ring, u, parts, [&](double area, const RingPoint& p) {
    const Tensor<2> h = Eigen::Map<const fem::Gradients>(p.values.data()) * p.gradients.transpose();
    const Tensor<2> stress = stress_of(h);
    const Vector<2> grad_q = p.gradients * p.q;
    for (std::size_t k = 0; k < 3; ++k) {
      const Tensor<2> known = frame.gradient(kTipLoads[k], body.law, p.at, side);
      sums[k] +=
          area * ((known * tip.direction).dot(stress * grad_q) + (h * tip.direction).dot(stress_of(known) * grad_q) -
                  stress.cwiseProduct(known).sum() * grad_q.dot(tip.direction));
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_DOUBLE, MPI_SUM, body.mesh.comm());
  const double modulus = law::crack_modulus(body.law);
  return {0.5 * modulus * sums[0], 0.5 * modulus * sums[1], modulus * sums[2]};
}
} // namespace pdx::post
