#include "pdx/adapt/fill.hpp"

#include "pdx/adapt/nodal_gradients.hpp"
#include "pdx/geom/box_cover.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/sites.hpp"

#include <algorithm>
#include <limits>

namespace pdx::adapt {
namespace {
constexpr Index kAnyBand = std::numeric_limits<Index>::max() / 4;

/// A patch that shows the lattice of new particles.
const couple::PatchShape& shape_for(std::span<const couple::PatchShape> shapes, const LayoutChange::Cover& cover)
{
  const auto of = std::ranges::find_if(shapes, [&cover](const couple::PatchShape& shape) {
    return geom::same_lattice(anchor_of(shape.lattice), cover.lattice());
  });
  if (of == shapes.end()) throw std::logic_error("no patch has the lattice of particles to come");
  return *of;
}

Vector<2> value_of(std::span<const double> field, Index row)
{
  return {field[2 * static_cast<std::size_t>(row)], field[2 * static_cast<std::size_t>(row) + 1]};
}

/// A point of an element, from which the element's fields follow: sum of N_a (u_a + g_a (x - x_a) / 2), which is exact
/// for quadratics on rectangles, where the nodes have gradients and no crack cuts; else as the element has them.
class PointInElement {
public:
  PointInElement(const SceneView& scene, const NodalGradients& gradients, Index cell, const Vector<2>& x)
      : scene_(scene), gradients_(gradients), cell_(cell), x_(x),
        host_(couple::host_in_cell({scene.mesh, scene.node_rows, scene.sets}, cell, x)),
        weights_(mesh::bilinear_weights(scene.mesh.corners(cell), x)), bends_(!scene.sets || !scene.sets->cut(cell))
  {}

  Vector<2> operator()(std::span<const double> field, std::size_t number) const
  {
    Vector<2> value = Vector<2>::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(host_.count); ++k)
      value += host_.weights[k] * value_of(field, scene_.halo.local(host_.rows[k]));
    return bends_ ? Vector<2>(value + bend(number)) : value;
  }

private:
  Vector<2> bend(std::size_t number) const
  {
    Vector<2> more = Vector<2>::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      const Index v = scene_.mesh.cell(cell_)[a];
      const std::optional<Tensor<2>> g = gradients_.at(v, number);
      if (!g) return Vector<2>::Zero();
      more += 0.5 * weights_[a] * (*g * (x_ - scene_.mesh.point(v)));
    }
    return more;
  }

  const SceneView& scene_;
  const NodalGradients& gradients_;
  Index cell_;
  Vector<2> x_;
  couple::Host host_;
  std::array<double, 4> weights_;
  bool bends_;
};
} // namespace

FreshRows fill_particles(const SceneView& scene, std::span<const LayoutChange::Cover> covers,
                         std::span<const couple::PatchShape> shapes, std::span<const std::span<const double>> fields)
{
  const mesh::Mesh& mesh = scene.mesh;
  std::vector<geom::Box<2>> boxes;
  for (const LayoutChange::Cover& cover : covers) boxes.push_back(cover.box);
  const NodalGradients gradients(scene, boxes, fields);
  FreshRows fresh;
  fresh.fields.resize(fields.size());
  for (const Index c : mesh.finder().around(boxes)) {
    if (c >= mesh.owned_cells() || mesh.use(c) == mesh::Use::covered) continue;
    const auto cover = std::ranges::find_if(covers, [middle = mesh.centroid(c), body = mesh.body(c)](const auto& of) {
      return of.body == body && of.box.contains(middle);
    });
    if (cover == covers.end()) continue;
    const couple::PatchShape& shape = shape_for(shapes, *cover);
    mesh::for_each_site(mesh, c, shape.lattice, kAnyBand, [&](const Site<2>& site, const Vector<2>& x) {
      fresh.names.push_back(field::RowName::particle(shape.names.of(site)));
      const PointInElement point(scene, gradients, c, x);
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const Vector<2> value = point(fields[f], f);
        fresh.fields[f].insert(fresh.fields[f].end(), {value[0], value[1]});
      }
    });
  }
  return fresh;
}
} // namespace pdx::adapt
