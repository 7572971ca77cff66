#pragma once
#include "pdx/fem/element.hpp"
#include "pdx/field/term.hpp"
#include "pdx/law/regions.hpp"
#include "pdx/xfem/enriched_sets.hpp"

namespace pdx::xfem {
/// The elements that cracks cut [XPD1 Eqs. 12, 13], assembled. The cut cells are read once, at construction; the mesh
/// is borrowed until then only.
class EnrichedTerm final : public field::Term {
public:
  /// @param node_rows global row of every local vertex, read at those of cut cells; `sets` must be numbered and outlive
  ///        the Term
  /// @param regions of other materials, by the middle of a whole cell; borrowed until then only; null: all is of `law`
  EnrichedTerm(const mesh::Mesh& mesh, const law::Elastic& law, law::Kinematics kinematics,
               const std::vector<PetscInt>& node_rows, const EnrichedSets& sets, const law::Regions* regions = nullptr);

  void needed_rows(std::vector<PetscInt>& rows) const override;
  void bind(const field::RowHalo& halo) override;
  /// Small strain only.
  void swell(const field::FreeStrain& strain) override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override;
  void couplings(field::Couplings& couplings, bool whole) const override;
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  bool constant_jacobian() const override { return kinematics_ == law::Kinematics::small; }
  bool fixed() const override { return constant_jacobian(); }
  /// On either side of the crack an element is a plain one, with the corner values u or w (`field::Tie`). A quarter of
  /// the side's mass moves with each of the four: total mass, and momentum and kinetic energy of either half alone,
  /// are exact. Unlike masses of (u, a) [XPD2 Eqs. 4-7] it leaves the stable step above a bound for every crack.
  void add_mass(std::span<double> mass) const override;
  void add_stiffness_bound(std::span<double> blocks) const override;
  void ties(std::vector<field::Tie>& ties) const override;

private:
  /// A cut cell as this rank works it.
  struct Part {
    const EnrichedElement* element;
    bool counted;                      ///< its energy, by this rank
    std::vector<PetscInt> global_rows; ///< of its corners, then of their sets
    std::vector<Index> rows;           ///< the same, local
    EnrichedMatrix stiffness;          ///< (small only) [N/m]
    EnrichedVector state;              ///< displacement at the last linearisation (finite only) [m]
    law::Elastic law;
    fem::Corners corners;         ///< of the whole cell [m]
    EnrichedVector swelling = {}; ///< as fem::SwellingLoad::force; empty: nothing swells [N]
    double swelling_energy = 0.0; ///< [J]
  };

  struct GlobalTie {
    PetscInt row, set;
    double factor;
  };
  /// Calls visit(points, local rows of the corner values, law) for each side of each element that has a part.
  template <class Visit> void for_each_side(Visit&& visit) const;

  law::Kinematics kinematics_;
  std::vector<Part> parts_;
  std::vector<GlobalTie> ties_; ///< one per owned set
  Index owned_rows_ = 0;
  PetscInt first_row_ = 0;
};
} // namespace pdx::xfem
