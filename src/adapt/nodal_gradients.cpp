#include "pdx/adapt/nodal_gradients.hpp"

#include "pdx/base/symmetric.hpp"
#include "pdx/geom/box_cover.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::adapt {
namespace {
constexpr double kSingular = 1e-6;  // smallest over largest eigenvalue of equations that say enough
constexpr Eigen::Index kTerms = 5;  // of a quadratic without its constant
constexpr std::size_t kMatrix = 25; // entries
using Terms = Eigen::Matrix<double, kTerms, 1>;
using Normal = Eigen::Matrix<double, kTerms, kTerms>;
using Sides = Eigen::Matrix<double, kTerms, Eigen::Dynamic>;

Terms terms_of(const Vector<2>& d) { return {d[0], d[1], 0.5 * d[0] * d[0], d[0] * d[1], 0.5 * d[1] * d[1]}; }

/// The side of elements beside the first patch, else that of a mean cell [m].
double scale_of(const SceneView& scene)
{
  const double edge =
      scene.around.empty() ? std::numeric_limits<double>::infinity() : scene.around.front().shortest_edge();
  return std::isfinite(edge) ? edge : std::sqrt(scene.mesh.bounds().size().prod() / scene.mesh.global_cells());
}

/// What a vertex has of its equations, by the number of right sides: matrix, right sides, and damaged particles.
constexpr std::size_t width_of(std::size_t sides) { return kMatrix + kTerms * sides + 1; }

/// Writes this rank's share of the equations, and solves them.
class Equations {
public:
  Equations(const SceneView& scene, std::span<const std::span<const double>> fields, VertexSums& sums)
      : scene_(scene), fields_(fields), sides_(2 * fields.size()), scale_(scale_of(scene)), sums_(sums)
  {}

  void add_nodes()
  {
    const mesh::Mesh& mesh = scene_.mesh;
    for (const Index c : mesh.finder().at_any(sums_.vertices())) {
      if (c >= mesh.owned_cells() || mesh.use(c) == mesh::Use::covered) continue;
      const auto& cell = mesh.cell(c);
      for (const Index a : cell)
        for (const Index b : cell)
          if (a != b && sums_.wanted(a)) add(a, {mesh.point(b), row_of(b), 1.0});
    }
  }

  void add_particles()
  {
    std::vector<std::uint8_t> asked(static_cast<std::size_t>(scene_.mesh.cells()), 0); // cells at a wanted vertex
    for (const Index c : scene_.mesh.cells(mesh::Use::covered))
      asked[static_cast<std::size_t>(c)] =
          std::ranges::any_of(scene_.mesh.cell(c), [this](Index a) { return sums_.wanted(a); });
    if (std::ranges::none_of(asked, [](std::uint8_t yes) { return yes; })) return;
    const couple::ParticleDamage all = couple::particle_damage(scene_.halo.rows(), scene_.bonds, scene_.carried);
    const Index first = scene_.halo.rows().first_particle();
    for (std::size_t k = 0; k < scene_.particles.size(); ++k) {
      const pd::Particle& p = scene_.particles[k];
      if (!asked[static_cast<std::size_t>(p.cell)]) continue;
      const double dx = scene_.around[static_cast<std::size_t>(p.patch)].shape().lattice.dx;
      for (const Index a : scene_.mesh.cell(p.cell)) {
        if (!sums_.wanted(a)) continue;
        const double h = size_of(p.cell);
        if (all.damage[k] > kBroken)
          sums_.at(a)[width_of(sides_) - 1] += 1.0;
        else
          add(a, {p.x, static_cast<std::size_t>(first) + k, 3.0 * dx * dx / (h * h)});
      }
    }
  }

  /// Gradients of all fields at a vertex take the place of its equations, NaN for none.
  void solve(Index vertex)
  {
    double* sums = sums_.at(vertex);
    const Normal matrix = Eigen::Map<const Normal>(sums);
    const Sides sides = Eigen::Map<const Sides>(sums + kMatrix, kTerms, static_cast<Eigen::Index>(sides_));
    const bool damaged = sums[width_of(sides_) - 1] > 0.0;
    Eigen::Map<Eigen::Matrix<double, 2, Eigen::Dynamic>> result(sums, 2, static_cast<Eigen::Index>(sides_));
    result.setConstant(std::numeric_limits<double>::quiet_NaN());
    if (damaged) return;
    if (says_enough(symmetric_eigenvalues(matrix)))
      result = matrix.ldlt().solve(sides).topRows<2>() / scale_;
    else if (const Eigen::Matrix2d plane = matrix.topLeftCorner<2, 2>(); says_enough(symmetric_eigenvalues(plane)))
      result = plane.ldlt().solve(sides.topRows<2>()) / scale_;
  }

private:
  struct Neighbour {
    Vector<2> x;
    std::size_t row;
    double weight;
  };
  static bool says_enough(const Eigen::VectorXd& values) { return values.minCoeff() > kSingular * values.maxCoeff(); }
  std::size_t row_of(Index vertex) const
  {
    return static_cast<std::size_t>(scene_.halo.local(scene_.node_rows[static_cast<std::size_t>(vertex)]));
  }
  double size_of(Index cell) const
  {
    const auto x = scene_.mesh.corners(cell);
    return std::sqrt(0.5 * (x[2] - x[0]).squaredNorm());
  }

  void add(Index vertex, const Neighbour& neighbour)
  {
    const Vector<2>& x = scene_.mesh.point(vertex);
    if (scene_.sets && scene_.sets->cracks().cuts(x, neighbour.x)) return;
    const Terms terms = terms_of((neighbour.x - x) / scale_);
    double* sums = sums_.at(vertex);
    Eigen::Map<Normal>{sums} += neighbour.weight * terms * terms.transpose();
    Eigen::Map<Sides> sides(sums + kMatrix, kTerms, static_cast<Eigen::Index>(sides_));
    const std::size_t own = row_of(vertex);
    for (std::size_t f = 0; f < fields_.size(); ++f)
      for (std::size_t d = 0; d < 2; ++d)
        sides.col(static_cast<Eigen::Index>(2 * f + d)) +=
            neighbour.weight * (fields_[f][2 * neighbour.row + d] - fields_[f][2 * own + d]) * terms;
  }

  const SceneView& scene_;
  std::span<const std::span<const double>> fields_;
  std::size_t sides_;
  double scale_; // of distances, so that equations are well scaled [m]
  VertexSums& sums_;
};
} // namespace

NodalGradients::NodalGradients(const SceneView& scene, std::span<const geom::Box<2>> boxes,
                               std::span<const std::span<const double>> fields)
    : sums_(scene.mesh, width_of(2 * fields.size()), boxes, [&](Index v) {
        return scene.node_rows[static_cast<std::size_t>(v)] >= 0 && geom::hold(boxes, scene.mesh.point(v));
      })
{
  Equations equations(scene, fields, sums_);
  equations.add_nodes();
  equations.add_particles();
  sums_.sum_up();
  for (const Index v : sums_.vertices()) equations.solve(v);
}

std::optional<Tensor<2>> NodalGradients::at(Index vertex, std::size_t field) const
{
  const double* g = sums_.at(vertex) + 4 * field;
  if (std::isnan(g[0])) return std::nullopt;
  return Tensor<2>{{g[0], g[1]}, {g[2], g[3]}};
}
} // namespace pdx::adapt
