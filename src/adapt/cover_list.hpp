#pragma once
#include "pdx/adapt/divided.hpp"
#include "pdx/adapt/layout_change.hpp"
#include "pdx/adapt/scene_view.hpp"

namespace pdx::adapt {
/// A cell that is to become particles, as it is told to other ranks.
struct Found {
  Index cell; ///< natural number
  Index body;
  std::array<double, 4> box; ///< lower and upper corner [m]
  double spacing;            ///< [m]
};
Found found(const mesh::Mesh& mesh, Index cell, const geom::Box<2>& box, double spacing);

/// Those of all ranks, by natural number. Collective.
std::vector<LayoutChange::Cover> gathered(MPI_Comm comm, const std::vector<Found>& mine);

/// Would a patch of another lattice of the same body share a side or a corner with a box?
bool meets_another(const SceneView& scene, Index body, const geom::Box<2>& box, const geom::LatticeAnchor& lattice);

/// Without those that would touch an earlier one of another lattice.
std::vector<LayoutChange::Cover> apart(const std::vector<LayoutChange::Cover>& covers);

/// Which cells some node of is held. Collective.
class HeldCells {
public:
  /// @param asked else none is
  HeldCells(const SceneView& scene, bool asked);
  bool has(Index cell) const;

private:
  const mesh::Mesh& mesh_;
  std::vector<int> node_;
};

/// May a cell that is no particles' become theirs?
bool can_cover(const SceneView& scene, Index cell);
} // namespace pdx::adapt
