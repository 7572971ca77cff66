#pragma once
#include "pdx/solve/prolongation.hpp"
#include "pdx/solve/tangent_operator.hpp"

namespace pdx::solve {
/// The default static preconditioner: PCMG with two levels. Fine level: Chebyshev with block Jacobi on the matrix-free
/// tangent. Coarse level: the CoarseSpace under one BoomerAMG cycle. Every part keeps its PETSc options
/// (-mg_levels_..., -mg_coarse_...).
class TwoLevel {
public:
  TwoLevel(const field::System& system, const TangentOperator& tangent);
  /// Makes `pc` this preconditioner; options of the user may still change it.
  void configure(PC pc);
  /// Builds anew: coarse rows where they changed, coarse operator at displacement u (local blocks). Does nothing if
  /// the user chose another PC. The smoother follows the tangent when PETSc sets `pc` up next. Collective.
  void update(PC pc, std::span<const double> u);
  /// Widens the smoother's interval to the bound that holds for any elements and bonds; false if it is there already
  /// or was chosen by the user.
  bool widen(PC pc);

private:
  const field::System& system_;
  const TangentOperator& tangent_;
  std::unique_ptr<Prolongation> prolongation_;
  MatHandle coarse_;
  bool wide_ = false;
};

/// Multigrid on the whole tangent (BoomerAMG as `-pc_type hypre`): from now on its sweeps take what other ranks have by
/// sums of its size [Baker, Falgout, Kolev, Yang 2011, "Multigrid smoothers for ultraparallel computing", l1]. Plain
/// ones need not be definite where rows of several ranks hang together strongly, as the copies of a node do. False on
/// one rank, for another preconditioner, or where the user chose the sweeps.
bool sweep_safely(PC pc);
} // namespace pdx::solve
