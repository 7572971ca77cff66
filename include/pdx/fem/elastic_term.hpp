#pragma once
#include "pdx/fem/assembly.hpp"
#include "pdx/fem/corner_areas.hpp"
#include "pdx/fem/element_sweep.hpp"
#include "pdx/field/parted.hpp"
#include "pdx/field/term.hpp"

#include <optional>

namespace pdx::fem {
/// Elements of the plain cells. Forces and energies come from a sweep in lanes. The tangent of small strain on a mesh
/// of few shapes acts without a matrix where all nodes of a cell are owned; what is left to the sparse part are
/// diagonal blocks and the cells at the border of the rank. The uses of the cells are read at construction, and those
/// of what changed by `change`: the Term may outlive a layout. The mesh must outlive the Term.
class ElasticTerm final : public field::Term, public field::Parted {
public:
  /// @param node_rows global row of every local vertex, -1 where no plain cell needs one; the rows of owned vertices
  ///        are owned rows
  /// @param regions outlives the Term; null: all is of `law`
  /// @param areas of this mesh, must outlive the Term; null: it has its own
  ElasticTerm(const mesh::Mesh& mesh, const law::Elastic& law, Kinematics kinematics, std::vector<PetscInt> node_rows,
              const law::Regions* regions = nullptr, const CornerAreas* areas = nullptr);

  /// Some cells have another use, and rows other numbers: all else stays. Before it is bound again.
  /// @param cells local ones, ascending
  void change(std::span<const Index> cells, std::vector<PetscInt> node_rows);
  /// From now on `energy` is that of some cells; nothing: of all. @param cells ascending
  void count_only(std::optional<std::vector<Index>> cells);

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  /// Small strain only.
  void swell(const field::FreeStrain& strain) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  void part(std::span<const std::uint8_t> marked, std::span<std::uint8_t> near) override;
  void add_near(std::span<const double> u, std::span<double> r) const override;
  void add_far(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  void add_tangent_action(std::span<const double> x, std::span<double> y) const override;
  bool constant_jacobian() const override { return body_.kinematics == Kinematics::small; }
  bool fixed() const override { return constant_jacobian(); }
  void add_mass(std::span<double> mass) const override { add_mass_in(owned_nodes(), mass); }
  void add_mass_in(field::RowRanges wanted, std::span<double> mass) const override;
  /// Each element by the largest eigenvalue of its stiffness over its lumped mass: elements alone in space would be
  /// that stiff. In a uniform plate the step comes out 13 to 15 % short.
  void add_stiffness_bound(std::span<double> blocks) const override { add_stiffness_bound_in(owned_nodes(), blocks); }
  void add_stiffness_bound_in(field::RowRanges wanted, std::span<double> blocks) const override;
  void add_far_bound(std::span<double> blocks) const override;

private:
  using CellRows = std::array<Index, 4>;
  CellRows rows_of(Index cell) const;
  bool is_mine(Index cell) const { return body_.mesh.cell_owner(cell) == rank_; }
  bool is_taken(Index cell) const;
  bool has_cell_at(Index vertex) const;
  std::vector<Index> halo_vertices() const;
  bool number_rows(const field::RowHalo& halo, std::vector<Index>& now);
  ElementSweep::Element element(Index cell) const { return {body_.mesh.corners(cell), rows_of(cell), is_mine(cell)}; }
  std::vector<ElementSweep> swept(std::span<const Index> cells) const;
  void sort_for_sweeps();
  void know_tangent() const;
  void keep_stiffness() const;
  void sort_out_free_cells() const;
  void add_free_diagonal(field::BlockAdder& adder) const;
  /// What vertices have of mass and bound, by cells.
  ///@{
  std::array<std::array<Index, 2>, 1> owned_nodes() const { return {{{0, static_cast<Index>(row_vertex_.size())}}}; }
  void know_ratios() const;
  void know_vertices() const;
  void sum_up(Index vertex) const;
  ///@}

  /// Cells of one shape that need no matrix.
  struct FreeCells {
    ElementMatrix stiffness;    ///< [N/m]
    ElementMatrix off_diagonal; ///< without the 2 x 2 blocks on its diagonal [N/m]
    std::vector<CellRows> rows; ///< of their nodes
  };

  ElasticBody body_;
  std::optional<CornerAreas> own_areas_;
  const CornerAreas& areas_;
  std::vector<PetscInt> node_rows_;
  int rank_ = 0;
  std::vector<Index> cells_;              ///< plain cells that touch an owned vertex or are owned, ascending
  std::vector<Index> leaving_, entering_; ///< of cells_, since it was bound
  mutable bool tangent_known_ = false;    ///< the four below, and border_
  mutable std::vector<Index> shape_;      ///< per entry of cells_: its entry of stiffness_, if that has any
  mutable std::vector<ElementMatrix>
      stiffness_;                 ///< of the distinct shapes, in order of appearance; none if finite, or many [N/m]
  std::vector<Index> local_rows_; ///< per local vertex, -1 where unused
  std::vector<Index> row_vertex_; ///< vertex of each owned node row, -1 where unused
  mutable std::vector<double> ratios_;    ///< per local cell, of stiffness over mass; empty: unknown [N/m^3]
  mutable std::vector<Vector<2>> sums_;   ///< per owned vertex: mass [kg], bound [N/m]; empty: unknown
  std::vector<double> node_displacement_; ///< 2 per local vertex, at the last linearisation (finite only) [m]
  mutable std::vector<FreeCells> free_;   ///< by shape
  mutable std::vector<Index> border_;     ///< cells that are not free
  std::vector<ElementSweep> sweeps_;      ///< over cells_, one for each law; first of those near
  std::size_t near_sweeps_ = 0;           ///< of sweeps_
  std::optional<std::vector<ElementSweep>> counted_only_; ///< none: all count
  std::vector<std::uint8_t> far_;                         ///< per entry of cells_; empty: all are near
  std::vector<double> swelling_; ///< 2 per owned row, see SwellingLoad; empty: nothing swells [N]
  double swelling_energy_ = 0.0; ///< of counted cells [J]
  Index owned_rows_ = 0;
};
} // namespace pdx::fem
