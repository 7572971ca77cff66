#pragma once
#include "pdx/field/block_adder.hpp"
#include "pdx/field/free_strain.hpp"
#include "pdx/field/rows.hpp"
#include "pdx/field/tie.hpp"

namespace pdx::field {
/// One physical contribution to the residual (elements, bonds, carried bonds). Solvers know Terms, never physics.
/// Called once per evaluation, never per bond or cell. Local blocks are [owned | halo], dim values per row.
class Term {
public:
  virtual ~Term() = default;

  /// Global rows of other ranks that this Term reads or couples with.
  virtual void needed_rows(std::vector<PetscInt>& rows) const = 0;
  /// Called once, when the halo is known: translate global rows into local ones here.
  virtual void bind(const RowHalo& halo) = 0;

  /// r += internal force [N] of the owned rows at displacement u [m].
  /// @param u halo.size() * dim   @param r owned * dim
  virtual void add_residual(std::span<const double> u, std::span<double> r) const = 0;
  /// From now on the material has this free strain; before the first call, none. A tangent that is constant stays as it
  /// is.
  virtual void swell(const FreeStrain& strain) { (void)strain; }
  /// Time that `add_residual` has spent waiting for other ranks [s].
  virtual double waited() const { return 0.0; }
  /// True if the Term resists motion too: explicit steps then call `add_damping`.
  virtual bool damps() const { return false; }
  /// r += force against the velocity [N] of the owned rows, opposed to motion like that of `add_residual`.
  /// @param u, v halo.size() * dim [m], [m/s]   @param r owned * dim
  virtual void add_damping(std::span<const double> u, std::span<const double> v, std::span<double> r) const
  {
    (void)u, (void)v, (void)r;
  }
  /// Strain energy of what this rank counts as its own [J]; the sum over ranks is the Term's energy.
  virtual double energy(std::span<const double> u) const = 0;

  /// Fixes the state at which tangents are taken. Called before the three below.
  virtual void linearise(std::span<const double> u) { (void)u; }
  /// The sparse part of the tangent: everything if `whole`, else only what `add_tangent_action` leaves out.
  virtual void couplings(Couplings& couplings, bool whole) const = 0;
  virtual void add_jacobian(BlockAdder& adder, bool whole) const = 0;
  /// y += (rest of the tangent) x without a matrix. x, y: owned * dim; x is zero at prescribed components.
  virtual void add_tangent_action(std::span<const double> x, std::span<double> y) const
  {
    (void)x;
    (void)y;
  }
  /// Owned rows that may have lost all stiffness in some direction (particles that lost bonds), repeats allowed. Where
  /// the diagonal block of the whole tangent is singular, the row is held in that direction: nothing else feels it.
  virtual void weak_rows(std::vector<Index>& rows) const { (void)rows; }
  /// True if the tangent does not depend on u: it is then built once, and again only after an AfterSolve changed
  /// something.
  virtual bool constant_jacobian() const { return false; }
  /// Of a Term with a constant tangent: another number after an AfterSolve changed it, or changed it back.
  virtual std::int64_t revision() const { return 0; }
  /// True if the force is a matrix times u and that matrix stays the same whatever is solved and whatever breaks.
  virtual bool fixed() const { return false; }
  /// True if the tangent is symmetric.
  virtual bool symmetric() const { return true; }

  /// Adds the lumped mass [kg] of the owned rows. A tied row holds the mass of what moves with its tied displacement.
  /// @param mass one entry per owned row
  virtual void add_mass(std::span<double> mass) const { (void)mass; }
  /// Adds blocks D_i [N/m] of the owned rows that bound the tangent at rest from above: u.K u <= sum_i u_i.D_i u_i for
  /// all u, in tied displacements. Such bounds add up over Terms, and no frequency of the whole is above
  /// max_i sqrt(lambda_max(D_i) / m_i).
  /// @param blocks owned rows * dim * dim, row-major
  virtual void add_stiffness_bound(std::span<double> blocks) const { (void)blocks; }
  /// The two above where the rest is known: what is added to rows outside some ranges does not matter.
  ///@{
  virtual void add_mass_in(RowRanges wanted, std::span<double> mass) const
  {
    (void)wanted;
    add_mass(mass);
  }
  virtual void add_stiffness_bound_in(RowRanges wanted, std::span<double> blocks) const
  {
    (void)wanted;
    add_stiffness_bound(blocks);
  }
  ///@}
  /// Appends the ties of owned rows.
  virtual void ties(std::vector<Tie>& ties) const { (void)ties; }
};
} // namespace pdx::field
