#pragma once
#include "pdx/adapt/scene_view.hpp"
#include "pdx/adapt/vertex_sums.hpp"

namespace pdx::adapt {
/// Gradients of fields at mesh vertices: of the quadratic through the vertex that fits best, by least squares, the
/// nodes and particles of the cells around it that no crack hides; of the plane, where those are too few.
class NodalGradients {
public:
  /// At the vertices with a row that boxes hold. @param boxes alike on every rank [m]
  /// @param fields local blocks [owned | halo] of two components each. Collective.
  NodalGradients(const SceneView& scene, std::span<const geom::Box<2>> boxes,
                 std::span<const std::span<const double>> fields);
  /// d f_i / d x_j of a field at a local vertex that was wanted, none where damaged particles or too few neighbours
  /// are.
  std::optional<Tensor<2>> at(Index vertex, std::size_t field) const;

private:
  VertexSums sums_; // the equations of each vertex; once solved, the gradients stand first
};
} // namespace pdx::adapt
