#include "pdx/adapt/hand_back.hpp"
#include "pdx/adapt/vertex_sums.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/geom/box_cover.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace pdx::adapt {
namespace {
constexpr double kEnough = 1e-7;     // smallest over largest eigenvalue of equations that say enough
constexpr Eigen::Index kSquares = 6; // terms of a quadratic
constexpr std::size_t kEntries = 36; // of its matrix
using Square = Eigen::Matrix<double, kSquares, 1>;
using Matrix = Eigen::Matrix<double, kSquares, kSquares>;
using SixSides = Eigen::Matrix<double, kSquares, Eigen::Dynamic>;

/// Of a distance in units of the radius.
double weight_at(double q) { return q < 1.0 ? (1.0 - q) * (1.0 - q) * (1.0 + 2.0 * q) : 0.0; }

double longest_side(const std::array<Vector<2>, 4>& corners)
{
  double side = 0.0;
  for (std::size_t a = 0; a < 4; ++a) side = std::max(side, (corners[(a + 1) % 4] - corners[a]).norm());
  return side;
}

/// The value at the vertex: of the quadratic, of a plane where that is too much for the particles, or their mean.
Eigen::RowVectorXd value_at_vertex(const double* sums, Eigen::Index sides)
{
  const Eigen::Map<const Matrix> matrix(sums);
  const Eigen::Map<const SixSides> right(sums + kEntries, kSquares, sides);
  for (const Eigen::Index terms : {Eigen::Index{6}, Eigen::Index{3}}) {
    const Eigen::MatrixXd part = matrix.topLeftCorner(terms, terms);
    const Eigen::VectorXd values = symmetric_eigenvalues(part);
    if (values.minCoeff() > kEnough * values.maxCoeff())
      return part.ldlt().solve(Eigen::MatrixXd(right.topRows(terms))).row(0);
  }
  return right.row(0) / matrix(0, 0);
}
} // namespace

FreshRows fill_nodes(const SceneView& scene, const LayoutChange& change,
                     std::span<const std::span<const double>> fields)
{
  const mesh::Mesh& mesh = scene.mesh;
  const crack::CrackSet paths(change.paths, mesh.bounds());
  const crack::CrackSet* hiding = change.paths.empty() && scene.sets ? &scene.sets->cracks() : &paths;
  const auto sides = static_cast<Eigen::Index>(2 * fields.size());
  VertexSums sums(mesh, kEntries + static_cast<std::size_t>(kSquares * sides), change.uncover, [&](Index v) {
    return scene.node_rows[static_cast<std::size_t>(v)] < 0 && geom::hold(change.uncover, mesh.point(v));
  });
  const auto first = static_cast<std::size_t>(scene.halo.rows().first_particle());
  for_each_particle_near(scene, change.uncover, [&](std::size_t k) {
    const pd::Particle& p = scene.particles[k];
    for (const Index v : mesh.cell(p.cell)) {
      if (!sums.wanted(v)) continue;
      const Vector<2> d = (p.x - mesh.point(v)) / longest_side(mesh.corners(p.cell));
      const double weight = weight_at(d.norm());
      if (weight == 0.0 || hiding->cuts(mesh.point(v), p.x)) continue;
      const Square terms{1.0, d[0], d[1], 0.5 * d[0] * d[0], d[0] * d[1], 0.5 * d[1] * d[1]};
      double* to = sums.at(v);
      Eigen::Map<Matrix>{to} += weight * terms * terms.transpose();
      Eigen::Map<SixSides> right(to + kEntries, kSquares, sides);
      for (Eigen::Index s = 0; s < sides; ++s)
        right.col(s) +=
            weight * fields[static_cast<std::size_t>(s / 2)][2 * (first + k) + static_cast<std::size_t>(s % 2)] * terms;
    }
  });
  sums.sum_up();

  FreshRows fresh;
  fresh.fields.resize(fields.size());
  for (const Index v : sums.vertices()) {
    if (v >= mesh.owned_vertices()) break;
    fresh.names.push_back(field::RowName::node(mesh.natural_vertex(v)));
    const Eigen::RowVectorXd value = value_at_vertex(sums.at(v), sides);
    for (std::size_t f = 0; f < fields.size(); ++f)
      for (Eigen::Index d = 0; d < 2; ++d) fresh.fields[f].push_back(value[static_cast<Eigen::Index>(2 * f) + d]);
  }
  return fresh;
}

FreshRows fill(const SceneView& scene, const LayoutChange& change, std::span<const couple::PatchShape> shapes,
               std::span<const std::span<const double>> fields)
{
  FreshRows fresh = change.cover.empty() ? FreshRows{{}, std::vector<std::vector<double>>(fields.size())}
                                         : fill_particles(scene, change.cover, shapes, fields);
  if (!change.uncover.empty()) fresh.append(fill_nodes(scene, change, fields));
  fresh.append(fresh_sets(scene, change, fields.size()));
  return fresh;
}

void FreshRows::append(const FreshRows& more)
{
  names.insert(names.end(), more.names.begin(), more.names.end());
  for (std::size_t f = 0; f < fields.size(); ++f)
    fields[f].insert(fields[f].end(), more.fields[f].begin(), more.fields[f].end());
}
} // namespace pdx::adapt
