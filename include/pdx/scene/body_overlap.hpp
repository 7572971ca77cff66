#pragma once
#include "pdx/scene/point_plan.hpp"

#include <mpi.h>

namespace pdx::scene {
/// Throws UserError for bodies of which one has a point inside the other, as deep as it may be, alike on every rank:
/// contact looks at surfaces only, and a body wholly inside another would be held there.
template <int Dim> void refuse_overlap(const PointPlan<Dim>& plan, const geom::Frame& frame);

/// The same of bodies of points and the elements beside them, `plan.first_cell` cells of the list of all, which rank 0
/// has. Collective.
void refuse_overlap(MPI_Comm comm, const PointPlan<2>& plan, const geom::Frame& frame);
} // namespace pdx::scene
