#pragma once
#include "pdx/adapt/conversion.hpp"
#include "pdx/adapt/expansion.hpp"
#include "pdx/adapt/fill.hpp"
#include "pdx/adapt/space_view.hpp"

namespace pdx::adapt {
/// Whole cells of the grids of bodies in space, ascending, each once.
using SpaceCells = std::vector<mpm::GridPlace<3>>;

/// Larger to smallest principal stretch less 1, of F = I + h: rotations feel nothing.
Vector<3> principal_strains(const Tensor<3>& h);

/// As BulkWatch, of the cells of material points in space.
class SpaceWatch {
public:
  SpaceWatch(const SpaceView& scene, const ConversionRule& rule);
  const ConversionRule& rule() const { return rule_; }
  /// Owned cells where strain or stress is above the rule's at one of eight places, those of points if there are
  /// 2 x 2 x 2. @param local displacement [owned | halo] [m]
  SpaceCells asking(std::span<const double> local) const;

private:
  struct Watched {
    mpm::GridPlace<3> cell;
    std::array<Index, 8> rows; // local
  };
  bool asks(const Watched& cell, std::span<const double> local) const;

  std::span<const mpm::Body<3>> bodies_;
  ConversionRule rule_;
  std::vector<Watched> cells_;
};

/// The cells that are to become particles: those that ask, and as many around in the same body as the margin says,
/// where they may. Alike on every rank. Collective.
SpaceCells conversion(const SpaceView& scene, const SpaceWatch& watch, std::span<const double> local);

/// Likewise beside what broke: cells as near as `expansion` to a particle that lost bonds to load and is nearer than
/// `critical` to a cell that may become particles. Alike on every rank. Collective.
SpaceCells expansion(const SpaceView& scene, const Reaches& reaches);

/// The particles that cells become, on the rank that has the cell: each field as the cell carries it there, bent by
/// central differences at its nodes where they have neighbours, as in the plane. Three components. Collective.
FreshRows fill(const SpaceView& scene, const SpaceCells& cells, std::span<const std::span<const double>> fields);
} // namespace pdx::adapt
