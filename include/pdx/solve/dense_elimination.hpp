#pragma once
#include <cstddef>
#include <span>
#include <vector>

namespace pdx::solve {
/// Rows of a square matrix, padded so that whole vectors of the processor end within a row.
class DenseSquare {
public:
  explicit DenseSquare(std::size_t size) : size_(size), pitch_((size + 15) / 16 * 16), values_(size * pitch_, 0.0) {}
  std::size_t size() const { return size_; }
  std::size_t pitch() const { return pitch_; }
  double* row(std::size_t r) { return values_.data() + r * pitch_; }
  const double* row(std::size_t r) const { return values_.data() + r * pitch_; }

private:
  std::size_t size_, pitch_;
  std::vector<double> values_;
};

/// The first components E of a symmetric positive definite matrix, eliminated: A_EE = U^T U, and of the others what is
/// left, A_RR - A_RE A_EE^-1 A_ER.
class DenseElimination {
public:
  /// @param matrix of which the upper triangle is read   @param eliminated how many of its first components
  DenseElimination(DenseSquare matrix, std::size_t eliminated);
  bool sound() const { return sound_; } ///< false: A_EE is not positive definite, or singular to rounding
  std::size_t eliminated() const { return eliminated_; }
  std::size_t left() const { return matrix_.size() - eliminated_; }
  /// What is left, the lower triangle too, row by row.
  std::vector<double> schur() const;
  /// Forces [E | R] -> [U^-T f_E | what comes to R].
  void condense(std::span<double> force) const;
  /// [U^-T f_E | u_R] -> [u_E | u_R] in equilibrium.
  void answer(std::span<double> x) const;

private:
  DenseSquare matrix_; // [U_EE U_ER; . schur], upper triangles
  std::size_t eliminated_;
  bool sound_ = true;
};
} // namespace pdx::solve
