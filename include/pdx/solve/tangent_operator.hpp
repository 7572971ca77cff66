#pragma once
#include "pdx/field/system.hpp"

#include <Eigen/Core>

namespace pdx::solve {
/// The tangent of a System as a PETSc matrix. Matrix-free: a shell that adds a sparse part (elements, carried bonds,
/// diagonal blocks) to what the Terms do without a matrix (lattice bonds). Assembled: one MATAIJ of everything.
class TangentOperator {
public:
  /// Collective.
  TangentOperator(const field::System& system, bool assembled);
  TangentOperator(const TangentOperator&) = delete;
  TangentOperator& operator=(const TangentOperator&) = delete;

  Mat matrix() const { return assembled_ ? sparse_.get() : shell_.get(); }
  bool assembled() const { return assembled_; }
  /// Takes the tangent at displacement u (local blocks [owned | halo]). Collective.
  void update(std::span<const double> u);
  int assemblies() const { return assemblies_; }
  /// Rows of all ranks that have no stiffness in some direction and are held there, at the last `update`.
  std::int64_t held_rows() const { return held_rows_; }
  /// Takes the parts of a force in which rows are held out of it. @param r owned * dim [N]
  void drop_held(std::span<double> r) const;

private:
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor, 3, 3>;
  static PetscErrorCode multiply(Mat shell, Vec x, Vec y);
  static PetscErrorCode diagonal(Mat shell, Vec d);
  static PetscErrorCode inverse_diagonal_blocks(Mat shell, const PetscScalar** values);
  void apply(Vec x, Vec y);
  void make_sparse();
  void make_shell();
  void reserve_diagonal();
  std::vector<int> moved_terms();
  void keep_steady(const std::vector<int>& moved);
  void hold_weak_rows();
  Block diagonal_block(Index row) const;

  const field::System& system_;
  bool assembled_;
  MatHandle sparse_, shell_;
  MatHandle steady_;                    // sum of the Terms that did not change lately; none before something changed
  std::vector<std::uint8_t> in_steady_; // per Term
  PetscObjectState pattern_ = 0;        // of the matrix that steady_ is like
  std::vector<std::int64_t> revisions_; // of the Terms at the last update
  std::vector<Index> held_components_;  // owned
  std::vector<double> masked_;
  struct WeakRow {
    Index row;  ///< owned
    Block free; ///< projector on the directions without stiffness, dim x dim
  };
  std::vector<WeakRow> weak_;
  std::int64_t held_rows_ = 0;
  int assemblies_ = 0;
};
} // namespace pdx::solve
