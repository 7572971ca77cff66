#pragma once
#include "pdx/field/system.hpp"

namespace pdx::solve {
/// Interpolation from coarse to fine rows as a PETSc matrix, the same weights for every direction. Prescribed fine
/// components get nothing and give nothing. The transpose restricts.
class Prolongation {
public:
  Prolongation(const field::System& system, const field::CoarseSpace& coarse);
  Prolongation(const Prolongation&) = delete;
  Prolongation& operator=(const Prolongation&) = delete;
  Mat matrix() const { return shell_.get(); }

private:
  static PetscErrorCode prolong(Mat shell, Vec coarse, Vec fine);
  static PetscErrorCode restrict_to(Mat shell, Vec fine, Vec coarse);
  void mask(double* fine) const;
  void take_back_prescribed(const double* fine);

  const field::System& system_;
  const field::CoarseSpace& coarse_;
  MatHandle shell_;
  std::vector<double> work_; // coarse local blocks
};
} // namespace pdx::solve
