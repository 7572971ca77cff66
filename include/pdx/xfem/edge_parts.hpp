#pragma once
#include "pdx/xfem/enriched_sets.hpp"

#include <vector>

namespace pdx::xfem {
/// Part of a boundary edge that lies on one side of a cut element, as fractions of the edge from its first vertex.
struct EdgePart {
  Side side;
  double begin, end;
};

/// Numbers of an edge's vertices among the corners of its cell.
std::array<std::size_t, 2> corners_of(const mesh::Mesh& mesh, const mesh::BoundaryEdge& edge);

/// @param cut of the edge's cell, or a piece of it: only what the piece has of the edge is told then
std::vector<EdgePart> edge_parts(const mesh::Mesh& mesh, const CutElement& cut, const mesh::BoundaryEdge& edge);

/// A place where the far half of a node begins on a boundary edge of the node, seen from there [m]; none where the
/// crack leaves the edge to other halves: a traction on the edge does not act on that one.
std::optional<Vector<2>> far_half_on(const mesh::Mesh& mesh, const EnrichedSets& sets, const mesh::BoundaryEdge& edge,
                                     Index vertex, const EnrichedSet& set);
} // namespace pdx::xfem
