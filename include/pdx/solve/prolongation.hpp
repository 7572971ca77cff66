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
  Mat matrix() const { return prolongation_.get(); }
  /// The transpose as a matrix of its own: PETSc tells the two apart by their sizes, which may happen to be equal.
  /// Where they are, and PETSc then asks for the transpose, the matrix itself.
  Mat restriction() const { return restriction_ ? restriction_.get() : prolongation_.get(); }

private:
  static PetscErrorCode prolong(Mat shell, Vec coarse, Vec fine);
  static PetscErrorCode restrict_to(Mat shell, Vec fine, Vec coarse);
  void mask(double* fine) const;
  void take_back_prescribed(const double* fine);

  const field::System& system_;
  const field::CoarseSpace& coarse_;
  MatHandle prolongation_, restriction_; // restriction_: where it is another matrix
  std::vector<double> work_;             // coarse local blocks
};
} // namespace pdx::solve
