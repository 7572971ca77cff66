#include "pdx/adapt/fill.hpp"

#include "pdx/adapt/nodal_gradients.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/sites.hpp"

#include <algorithm>
#include <limits>

namespace pdx::adapt {
namespace {
constexpr Index kAnyBand = std::numeric_limits<Index>::max() / 4;

/// The patch whose lattice a new particle is on.
const couple::PatchShape& shape_for(const SceneView& scene, const LayoutChange::Cover& cover)
{
  const auto of = std::ranges::find_if(scene.around, [&cover](const couple::Surroundings& around) {
    const geom::Lattice<2>& lattice = around.shape().lattice;
    const Vector<2> lines = (cover.box.lower - lattice.origin) / lattice.dx;
    return lattice.dx == cover.spacing && ((lines.array() - lines.array().round()).abs() < 1e-3).all();
  });
  return (of == scene.around.end() ? scene.around.front() : *of).shape();
}
constexpr double kAtCorner = 1e-6; // of the side of a box

Vector<2> value_of(std::span<const double> field, Index row)
{
  return {field[2 * static_cast<std::size_t>(row)], field[2 * static_cast<std::size_t>(row) + 1]};
}

/// Fields in an element at a point: sum of N_a (u_a + g_a (x - x_a) / 2), which is exact for quadratics on rectangles,
/// where the nodes have gradients; else as the element has them.
class Interpolant {
public:
  Interpolant(const SceneView& scene, const NodalGradients& gradients, Index cell)
      : scene_(scene), gradients_(gradients), cell_(cell), plain_(!scene.sets || !scene.sets->cut(cell))
  {}

  Vector<2> operator()(std::span<const double> field, std::size_t number, const Vector<2>& x) const
  {
    const couple::Host host = couple::host_in_cell({scene_.mesh, scene_.node_rows, scene_.sets}, cell_, x);
    Vector<2> value = Vector<2>::Zero();
    for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k)
      value += host.weights[k] * value_of(field, scene_.halo.local(host.rows[k]));
    return plain_ ? Vector<2>(value + bent(number, x)) : value;
  }

private:
  Vector<2> bent(std::size_t number, const Vector<2>& x) const
  {
    const auto weights = mesh::bilinear_weights(scene_.mesh.corners(cell_), x);
    Vector<2> more = Vector<2>::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      const Index v = scene_.mesh.cell(cell_)[a];
      const std::optional<Tensor<2>> g = gradients_.at(v, number);
      if (!g) return Vector<2>::Zero();
      more += 0.5 * weights[a] * (*g * (x - scene_.mesh.point(v)));
    }
    return more;
  }

  const SceneView& scene_;
  const NodalGradients& gradients_;
  Index cell_;
  bool plain_;
};
} // namespace

FreshRows fill_particles(const SceneView& scene, std::span<const LayoutChange::Cover> covers,
                         std::span<const std::span<const double>> fields)
{
  const mesh::Mesh& mesh = scene.mesh;
  const auto in_a_cover = [&covers](const Vector<2>& x) {
    return std::ranges::any_of(
        covers, [&x](const auto& of) { return of.box.contains(x, kAtCorner * of.box.size().minCoeff()); });
  };
  const NodalGradients gradients(scene, in_a_cover, fields);
  FreshRows fresh;
  fresh.fields.resize(fields.size());
  const auto fill_cell = [&](Index c, const LayoutChange::Cover& cover) {
    const couple::PatchShape& shape = shape_for(scene, cover);
    const Interpolant interpolant(scene, gradients, c);
    mesh::for_each_site(mesh, c, shape.lattice, kAnyBand, [&](const Site<2>& site, const Vector<2>& x) {
      fresh.names.push_back(field::RowName::particle(shape.names.of(site)));
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const Vector<2> value = interpolant(fields[f], f, x);
        fresh.fields[f].insert(fresh.fields[f].end(), {value[0], value[1]});
      }
    });
  };
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    if (mesh.use(c) == mesh::Use::covered) continue;
    const Vector<2> middle = mesh.centroid(c);
    const auto cover = std::ranges::find_if(covers, [&middle](const auto& of) { return of.box.contains(middle); });
    if (cover != covers.end()) fill_cell(c, *cover);
  }
  return fresh;
}
} // namespace pdx::adapt
