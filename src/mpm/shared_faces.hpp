#pragma once
#include "pdx/field/rows.hpp"
#include "pdx/mpm/cell_bound.hpp"
#include "pdx/mpm/point_cells.hpp"

#include <span>

namespace pdx::mpm {
/// Which parts of the faces of this rank's cells have points on both sides, whoever has the cell behind. Every cell is
/// given by one rank. Collective.
template <int Dim>
std::vector<SharedParts<Dim>> find_shared_faces(const field::Rows& rows, std::span<const PointCell<Dim>> cells,
                                                std::span<const BodyMaterial> bodies);

/// First rows of all ranks. Collective.
std::vector<PetscInt> first_rows(const field::Rows& rows);
/// The rank that owns a row; one without rows begins where the next does.
int owner_of(PetscInt row, std::span<const PetscInt> first);
} // namespace pdx::mpm
