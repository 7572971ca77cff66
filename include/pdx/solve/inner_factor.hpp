#pragma once
#include "pdx/base/petsc.hpp"

#include <span>
#include <string>
#include <vector>

namespace pdx::solve {
/// A distributed matrix as the first rank sees the whole of it; no matrix elsewhere. Collective.
class GatheredMatrix {
public:
  /// @param matrix MATAIJ, on one rank MATBAIJ too; must outlive it
  explicit GatheredMatrix(Mat matrix);
  Mat get() const { return whole_; }

private:
  MatHandle own_;
  Mat whole_ = nullptr;
};

/// values[places]
std::vector<double> pick(std::span<const double> values, std::span<const PetscInt> places);
/// y -= A x where x is `values` at `columns` and 0 elsewhere.
void subtract_product(Mat a, std::span<const PetscInt> columns, std::span<const double> values, std::vector<double>& y);

/// Components I of a symmetric matrix K on one rank, eliminated by a sparse Cholesky factor (MUMPS).
class InnerFactor {
public:
  /// @param inner, outer components I and G, each ascending; what K has elsewhere is left out
  /// @param condensed becomes K_GG - K_GI K_II^-1 K_IG, row by row
  InnerFactor(Mat k, std::span<const PetscInt> inner, std::span<const PetscInt> outer, std::vector<double>& condensed);
  const std::string& fault() const { return fault_; } ///< "" or why there is no factor
  /// K_II^-1 f
  std::vector<double> solve(std::vector<double> f) const;
  /// -K_II^-1 K_IG x
  std::vector<double> answer(std::span<const double> x) const;
  /// f - K_GI u
  std::vector<double> condensed(std::vector<double> f, std::span<const double> u) const;

private:
  struct Entry {
    PetscInt inner, outer;
    double value;
  };
  MatHandle matrix(Mat k, std::span<const PetscInt> inner, std::span<const PetscInt> outer);
  void judge(Mat whole);

  std::size_t inner_, outer_;
  std::vector<Entry> between_; // K_IG
  MatHandle factor_;
  std::string fault_;
};
} // namespace pdx::solve
