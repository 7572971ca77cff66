#pragma once
#include "pdx/couple/node_field.hpp"
#include "pdx/fem/assembly.hpp"
#include "pdx/field/coarse_space.hpp"
#include "pdx/field/system.hpp"

namespace pdx::couple {
/// A particle as the coarse level sees it: which row, in which local cell, where.
struct ParticlePlace {
  Index row;   ///< local row
  Index cell;  ///< local cell that holds it
  Vector<2> x; ///< [m]
};

/// The whole mesh, covered cells included, as coarse level: nodes of elements are coarse rows themselves, particles
/// hang bilinearly in the cell that holds them. One mesh, two jobs.
class CoarseMesh final : public field::CoarseSpace {
public:
  /// @param nodes owned local vertices in order of their fine rows. Collective.
  CoarseMesh(fem::ElasticBody body, const NodeField& node_field, std::span<const Index> nodes,
             std::span<const ParticlePlace> particles, const field::System& system);

  const field::RowHalo& halo() const override { return *halo_; }
  const field::Interpolation& interpolation() const override { return interpolation_; }
  MatHandle assemble(std::span<const double> u) override;
  std::vector<double> coordinates() const override;

private:
  void hold(std::span<const Index> nodes, std::span<const ParticlePlace> particles, const field::System& system);
  void add_springs(field::BlockAdder& adder) const;

  fem::ElasticBody body_;
  const NodeField& node_field_;
  field::Rows rows_;
  std::unique_ptr<field::RowHalo> halo_;
  std::vector<Index> local_rows_; // per local vertex
  std::vector<Index> cells_;      // local cells that touch an owned vertex
  field::Interpolation interpolation_;
  std::vector<std::uint8_t> held_; // per component of every local coarse row
  std::vector<double> leaning_;    // per component of owned coarse rows: weight of prescribed particles
  double scale_;
};
} // namespace pdx::couple
