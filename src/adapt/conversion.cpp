#include "pdx/adapt/conversion.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/fem/shape.hpp"
#include "pdx/geom/box_cover.hpp"

#include "cover_list.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::adapt {
namespace {
/// A cell that asks.
struct Asking {
  Index body;
  std::array<double, 4> box; ///< grown by the margin: lower and upper corner [m]
};

using Gradients = Eigen::Matrix<double, 4, 2>;

/// Gradients of the shape functions at four places of a cell, those of its points if it has 2 x 2; kept for the next
/// cell, which mostly is as large.
class CellGradients {
public:
  const std::array<Gradients, 4>& of(const Corners& corners)
  {
    const Vector<2> a = corners[1] - corners[0], b = corners[3] - corners[0], c = corners[2] - corners[0];
    const double near = 1e-9 * (a.cwiseAbs() + b.cwiseAbs()).sum();
    const bool same = (a - a_).cwiseAbs().sum() < near && (b - b_).cwiseAbs().sum() < near &&
                      (c - a - b).cwiseAbs().sum() < near;
    if (same) return at_;
    for (int g = 0; g < 4; ++g)
      at_[static_cast<std::size_t>(g)] =
          fem::map_point(corners, Vector<2>(g % 2 ? 0.5 : -0.5, g / 2 ? 0.5 : -0.5)).gradients.transpose();
    a_ = a;
    b_ = (c - a - b).cwiseAbs().sum() < near ? b : Vector<2>(0.0, 0.0); // the next is told from a parallelogram only
    return at_;
  }

private:
  std::array<Gradients, 4> at_{};
  Vector<2> a_ = Vector<2>::Zero(), b_ = Vector<2>::Zero();
};

/// Larger and smaller principal stretch less 1, of F = I + h: rotations feel nothing.
std::array<double, 2> principal_strains(const Tensor<2>& h)
{
  const double a = 1.0 + h(0, 0), b = h(0, 1), c = h(1, 0), d = 1.0 + h(1, 1);
  const double plus = std::hypot(a + d, c - b), minus = std::hypot(a - d, c + b);
  return {0.5 * (plus + minus) - 1.0, 0.5 * (plus - minus) - 1.0};
}

class Trial {
public:
  Trial(const SceneView& scene, const ConversionRule& rule, const BulkOfBodies& bulk, std::span<const double> local)
      : scene_(scene), rule_(rule), bulk_(bulk), local_(local)
  {}

  bool asks(Index cell)
  {
    const auto corners = scene_.mesh.corners(cell);
    Eigen::Matrix<double, 2, 4> u;
    for (int a = 0; a < 4; ++a) {
      const Index v = scene_.mesh.cell(cell)[static_cast<std::size_t>(a)];
      const Index row = scene_.halo.local(scene_.node_rows[static_cast<std::size_t>(v)]);
      u.col(a) = Eigen::Map<const Vector<2>>(&local_[2 * static_cast<std::size_t>(row)]);
    }
    const law::Elastic& elastic = bulk_.elastic(scene_.mesh.body(cell));
    for (const Gradients& gradients : gradients_.of(corners)) {
      const auto [large, small] = principal_strains(u * gradients);
      if (rule_.stretch && large >= *rule_.stretch) return true;
      if (rule_.stress && elastic.principal_stress(large, small) >= *rule_.stress) return true;
    }
    return false;
  }

private:
  const SceneView& scene_;
  const ConversionRule& rule_;
  const BulkOfBodies& bulk_;
  std::span<const double> local_;
  CellGradients gradients_;
};

/// That of a body's first patch, or what it begins with.
geom::LatticeAnchor lattice_of(const SceneView& scene, const BulkOfBodies& bulk, Index body)
{
  for (const couple::Surroundings& around : scene.around)
    if (around.shape().body == body) return anchor_of(around.shape().lattice);
  return bulk.lattices[static_cast<std::size_t>(body)];
}
} // namespace

std::vector<LayoutChange::Cover> conversion(const SceneView& scene, const ConversionRule& rule,
                                            const BulkOfBodies& bulk, std::span<const double> local)
{
  const mesh::Mesh& mesh = scene.mesh;
  Trial trial(scene, rule, bulk, local);
  std::vector<Asking> asking;
  for (const mesh::Use use : {mesh::Use::plain, mesh::Use::points})
    for (const Index c : mesh.cells(use)) {
      if (c >= mesh.owned_cells() || !can_cover(scene, c) || !trial.asks(c)) continue;
      const geom::Box<2> box = box_of(mesh, c);
      const Vector<2> more = (rule.margin - 0.5) * box.size(); // so that rounding leaves whole cells
      const Vector<2> lower = box.lower - more, upper = box.upper + more;
      asking.push_back({mesh.body(c), {lower[0], lower[1], upper[0], upper[1]}});
    }
  asking = gather_all(mesh.comm(), asking);
  if (asking.empty()) return {};
  const HeldCells held(scene, true);
  std::vector<Found> mine;
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    if (!can_cover(scene, c) || held.has(c)) continue;
    const geom::Box<2> box = box_of(mesh, c);
    const bool near = std::ranges::any_of(asking, [&](const Asking& by) {
      return by.body == mesh.body(c) && box.upper[0] > by.box[0] && box.upper[1] > by.box[1] &&
             box.lower[0] < by.box[2] && box.lower[1] < by.box[3];
    });
    if (!near) continue;
    const geom::LatticeAnchor anchor = lattice_of(scene, bulk, mesh.body(c));
    const geom::Lattice<2> lattice{anchor.corner, anchor.spacing, {1, 1}};
    if (is_divided(mesh.corners(c), lattice) && !meets_another(scene, mesh.body(c), box, anchor))
      mine.push_back(found(mesh, c, box, anchor.spacing));
  }
  return apart(gathered(mesh.comm(), mine));
}
} // namespace pdx::adapt
