#pragma once
#include "pdx/xfem/enriched_sets.hpp"

namespace pdx::xfem {
/// Where the two halves of a cut node count to be when places are chosen: the near half at the node, but clear of the
/// crack, the far half just behind the crack.
struct Halves {
  Vector<2> near, far; ///< [m]
};

/// @param vertex owned   @param set one of its sets
Halves halves_of(const mesh::Mesh& mesh, const EnrichedSets& sets, Index vertex, const EnrichedSet& set);
} // namespace pdx::xfem
