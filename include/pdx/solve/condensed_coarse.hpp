#pragma once
#include "pdx/solve/condensed_system.hpp"

namespace pdx::solve {
/// The coarse level of a condensed System: that of the whole one with its nodes and sets condensed in the same way.
class CondensedCoarse final : public field::CoarseSpace {
public:
  /// Both must outlive it. Collective.
  CondensedCoarse(const KeptRows& kept, const Condensation& condensation);
  const field::RowHalo& halo() const override { return *halo_; }
  const field::Interpolation& interpolation() const override { return interpolation_; }
  MatHandle assemble(std::span<const double> u) override;
  std::vector<double> coordinates() const override;
  bool rebuild() override;
  bool wants_factor() const override { return true; }

private:
  field::CoarseSpace& whole() const { return *kept_.whole().coarse; }
  void lay_out();
  void interpolate(std::span<const Index> column);
  void change_basis();

  const KeptRows& kept_;
  const Condensation& condensation_;
  std::vector<Index> owned_; // whole coarse rows of ours, ascending
  std::unique_ptr<field::RowHalo> halo_;
  field::Interpolation interpolation_;
  Condensation::Matrix stiffness_; // the condensed one in coarse unknowns, ours x all [N/m]
  std::vector<PetscInt> columns_;  // global coarse components of all kept ones
};
} // namespace pdx::solve
