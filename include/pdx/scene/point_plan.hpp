#pragma once
#include "pdx/mpm/body.hpp"
#include "pdx/options/scene_options.hpp"

namespace pdx::scene {
/// Bodies of material points, and how their grids stand in the mesh: a cell of the mesh is a column of grid cells along
/// z (in the plane: one), a vertex a column of nodes. Each body has cells and vertices of its own. Alike on every rank.
template <int Dim> struct PointPlan {
  std::vector<mpm::Body<Dim>> bodies;
  /// A column of cells, or of nodes, that holds or touches points.
  struct Column {
    Index body = 0;
    std::array<Index, 2> at{}; ///< place in the body's grid
  };
  std::vector<Column> cells; ///< by natural number: body by body, x fastest
  std::vector<Column> nodes; ///< likewise
  mesh::MeshOptions mesh;    ///< of these cells, with a cost each: its points; of a mixed scene without costs
  Index first_cell = 0, first_node = 0; ///< natural numbers of the first of `cells` and `nodes`: elements come before

  /// Number of the body that elements are, after those of points.
  Index elements() const { return static_cast<Index>(bodies.size()); }

  /// Layers along z with points, of a column of cells; with nodes, of one of nodes. Ascending; in the plane 0 alone.
  std::vector<Index> cell_layers(const Column& column) const;
  std::vector<Index> node_layers(const Column& column) const;
  std::int64_t count() const;                       ///< of all points
  std::vector<mpm::BodyMaterial> materials() const; ///< of the bodies
};

/// Fills the bodies, and moves the options into the frame around them and the elements, if there are any. In a scene
/// that is more than points (`SceneOptions::mixed`) `options.mesh` becomes the list of all cells; boundaries are
/// `left`, `right`, `bottom` and `top` of all bodies, and `NAME:left` ... of each, `mesh:...` those of elements. Throws
/// UserError for a shape that a spacing does not fit or that holds no point, and for a file that is no lattice.
/// @param edge shortest side of an element; infinite for none [m]
template <int Dim> PointPlan<Dim> plan_points(options::SceneOptions& options, double edge);
} // namespace pdx::scene
