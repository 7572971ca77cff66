#pragma once
#include "pdx/field/term.hpp"
#include "pdx/mpm/cell_blocks.hpp"
#include "pdx/mpm/point_cells.hpp"

namespace pdx::mpm {
/// Bodies of material points whose grid is kept (`total`): rows are the nodes of grids of the reference, displaced by
/// u. F = I + sum u_I (x) grad N_I(X_p) at each point, force sum V P(F) grad N_I, nothing is stored per point. A cell
/// with too few points for the modes it has is held by hourglass control (`cell_shape.hpp`).
template <int Dim> class PointTerm final : public field::Term {
public:
  /// Takes the cells of this rank; every cell of the scene is given by one rank, any that likes. Who owns a corner gets
  /// a copy, so that no force travels. Bodies, and their materials, are the same on every rank. Collective.
  /// @param viscosity linear bulk viscosity b of `add_damping`, of all bodies [-]
  PointTerm(const field::Rows& rows, std::vector<PointCell<Dim>> cells, std::vector<BodyMaterial> materials,
            double viscosity = 0.0);

  /// Leave cells out that rest, as `NodeFields::skipped` says? At first they are.
  void skip_rest(bool skip) { skips_ = skip; }
  /// Cells of this rank's passes so far: computed, and left out because they were at rest. Copies of cells count too.
  ///@{
  std::int64_t cells_computed() const { return passed_ - skipped_; }
  std::int64_t cells_skipped() const { return skipped_; }
  ///@}

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  bool constant_jacobian() const override { return false; }
  bool damps() const override { return viscosity_ > 0.0; }
  void add_damping(std::span<const double> u, std::span<const double> v, std::span<double> r) const override;
  /// By points: m_I = sum over points of m_p N_I(X_p).
  void add_mass(std::span<double> mass) const override;
  /// By `CellBounds`, the load of a cell on its corners moved from those that have much of it for their mass to others:
  /// 4 % below the longest step of a square, 5 to 7 % of a disc, 10 % of a cube or a ball. Viscous forces that lag half
  /// a step behind make it shorter: by sqrt(1 + q^2) - q, q = b (lambda + 2 mu) / (lambda + 2 mu / Dim). Collective.
  void add_stiffness_bound(std::span<double> blocks) const override;

  /// Linear bulk viscosity, first Piola stress b rho c_L h tr(D) cof F at the points, at displacement u and velocity v,
  /// both [owned | halo]: r += its force [N] on owned rows.
  /// @param b of all bodies [-]   @return power that this rank's points lose [W]
  double add_viscous(double b, std::span<const double> u, std::span<const double> v, std::span<double> r) const;

  /// The cells this rank was given, and the material points in them; points of a cell are in order of sites.
  std::span<const PointCell<Dim>> cells() const { return cells_; }
  std::span<const BodyMaterial> materials() const { return materials_; }
  Index points() const { return points_; }

  /// Per point of this rank, cell by cell:
  ///@{
  std::vector<Index> bodies() const;
  std::vector<double> masses() const; ///< [kg]
  /// sum of N_I times the values of rows: displacement from u, velocity from v. @return points() * Dim
  std::vector<double> interpolated(std::span<const double> values) const;
  /// Reference position. @param corners of each cell at its lowest corner [m]   @return points() * Dim
  std::vector<double> positions(std::span<const Vector<Dim>> corners) const;
  std::vector<double> deformation(std::span<const double> u) const; ///< F, points() * Dim * Dim, row by row [-]
  /// Cauchy's, in the plane by the thickness of the reference.
  std::vector<double> cauchy_stress(std::span<const double> u) const; ///< points() * Dim * Dim, row by row [Pa]
  ///@}

private:
  const BodyMaterial& material(Index body) const { return materials_[static_cast<std::size_t>(body)]; }
  const CellPoints<Dim>& pattern(const LocalCell<Dim>& cell) const { return patterns_.at(cell.body, cell.points); }
  /// Calls visit(cell, its pattern, number of its first point) for the cells of this rank.
  template <class Visit> void for_each_own(Visit&& visit) const;
  template <class Visit> std::vector<double> of_gradients(std::span<const double> u, Visit&& visit) const;

  std::vector<PointCell<Dim>> cells_, copies_; ///< given here; of other ranks, with a corner owned here
  std::vector<BodyMaterial> materials_;
  PointPatterns<Dim> patterns_;
  CellBlocks<Dim> own_, copied_;
  std::vector<LocalCell<Dim>> local_; ///< cells_, then copies_
  std::vector<double> displacement_;  ///< of local rows at the last linearisation [m]
  const field::RowHalo* halo_ = nullptr;
  Index points_ = 0, owned_rows_ = 0;
  double viscosity_; ///< b [-]
  bool skips_ = true;
  mutable std::int64_t passed_ = 0, skipped_ = 0;
  Processor processor_ = chosen_processor();
};
} // namespace pdx::mpm
