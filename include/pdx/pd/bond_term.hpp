#pragma once
#include "pdx/field/term.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <memory>

namespace pdx::pd {
/// The bonds between the particles of all patches. Matrix-free except for the diagonal blocks, or assembled in full
/// as reference (`-pd_operator assembled`).
template <int Dim> class BondTerm final : public field::Term {
public:
  BondTerm(std::vector<std::unique_ptr<LatticePart<Dim>>> parts, Kinematics kinematics, bool assembled);

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  void add_tangent_action(std::span<const double> x, std::span<double> y) const override;
  bool constant_jacobian() const override { return kinematics_ == Kinematics::linear; }

  const std::vector<std::unique_ptr<LatticePart<Dim>>>& parts() const { return parts_; }
  /// Strain energy density of the owned particles by their lattice bonds [J/m^3]; carried bonds add theirs.
  std::vector<double> energy_density(std::span<const double> u) const;

private:
  void add_diagonal(field::BlockAdder& adder) const;
  void add_whole(field::BlockAdder& adder, const LatticePart<Dim>& part, std::size_t number) const;

  std::vector<std::unique_ptr<LatticePart<Dim>>> parts_;
  Kinematics kinematics_;
  bool assembled_;
  const field::RowHalo* halo_ = nullptr;
  std::vector<typename LatticePart<Dim>::Window> state_; // displacement the tangent is taken at
  mutable std::vector<typename LatticePart<Dim>::Window> scratch_;
};
} // namespace pdx::pd
