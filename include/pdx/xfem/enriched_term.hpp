#pragma once
#include "pdx/field/term.hpp"
#include "pdx/xfem/enriched_sets.hpp"

namespace pdx::xfem {
/// The elements that cracks cut [XPD1 Eqs. 12, 13], assembled. The cut cells are read once, at construction; the mesh
/// is borrowed until then only.
class EnrichedTerm final : public field::Term {
public:
  /// @param node_rows global row of every local vertex, read at those of cut cells; `sets` must be numbered and outlive
  ///        the Term
  EnrichedTerm(const mesh::Mesh& mesh, const law::Elastic& law, fem::Kinematics kinematics,
               const std::vector<PetscInt>& node_rows, const EnrichedSets& sets);

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  bool constant_jacobian() const override { return kinematics_ == fem::Kinematics::small; }

private:
  /// A cut cell as this rank works it.
  struct Part {
    const EnrichedElement* element;
    bool counted;                      ///< its energy, by this rank
    std::vector<PetscInt> global_rows; ///< of its corners, then of their sets
    std::vector<Index> rows;           ///< the same, local
    EnrichedMatrix stiffness;          ///< (small only) [N/m]
    EnrichedVector state;              ///< displacement at the last linearisation (finite only) [m]
  };

  law::Elastic law_;
  fem::Kinematics kinematics_;
  std::vector<Part> parts_;
  Index owned_rows_ = 0;
};
} // namespace pdx::xfem
