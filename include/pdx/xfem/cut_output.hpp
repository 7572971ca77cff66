#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/field/rows.hpp"
#include "pdx/xfem/enriched_sets.hpp"

namespace pdx::xfem {
/// The owned cut cells as they open: block "cut_cells", in which each cell is two polygons that share no point, as fans
/// of four-node cells (the last corner twice where a triangle is left). Fields of the points: "displacement [m]" of
/// their side, and "side" (+1, -1). Point k of a side has number 16 * natural cell + 8 * (plus side) + k. Where several
/// cracks cut a cell it is its pieces instead, sides 2, 3, ..., and its points have numbers behind all others.
/// @param node_rows global row of every local vertex   @param u local blocks [owned | halo] [m]. Collective.
field::OutputBlock cut_block(const mesh::Mesh& mesh, const EnrichedSets& sets, std::span<const PetscInt> node_rows,
                             const field::RowHalo& halo, std::span<const double> u);
} // namespace pdx::xfem
