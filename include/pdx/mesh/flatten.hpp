#pragma once
#include "pdx/mesh/mesh.hpp"

namespace pdx::mesh {
/// Label of the outer boundary's edges in the DMPlex; value k is the k-th name.
inline constexpr const char* kBoundaryLabel = "pdx_boundary";

/// A DMPlex distributed with one layer of overlap.
struct DistributedPlex {
  DmHandle plex;
  std::vector<Index> natural; ///< per local point: number of the cell, or of the vertex, in the serial mesh
  std::vector<int> costs;     ///< per local point, of cells; empty on a single rank
};

/// Takes flat arrays from the plex; all but quality.imbalance is filled in. Collective.
/// @param boundaries names of the boundaries, the same on every rank
MeshArrays flatten(const DistributedPlex& distributed, std::span<const std::string> boundaries);
} // namespace pdx::mesh
