#include "pdx/solve/dense_elimination.hpp"

#include "pdx/base/lanes.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::solve {
namespace {
constexpr std::size_t kPanel = 32;  // rows that are eliminated at once: they stay in the nearest cache
constexpr double kSingular = 1e-13; // of a diagonal entry, what is left of it at its turn

/// A row pair of a panel from a column on: subtracts what row k takes.
template <int W>
PDX_INLINE void subtract_row(const double* row, double factor, double* from, std::size_t begin, std::size_t end)
{
  for (std::size_t j = begin / W * W; j < end; j += W)
    store<W>(load<W>(from + j) - factor * load<W>(row + j), from + j);
}

/// Cholesky by panels; what is below the diagonal is written over and never read.
struct EliminatePanels {
  DenseSquare& matrix;
  std::size_t eliminated;
  std::span<const double> diagonal; // as it was
  bool& sound;

  template <int W> PDX_INLINE void run() const
  {
    for (std::size_t first = 0; first < eliminated && sound; first += kPanel) {
      const std::size_t end = std::min(first + kPanel, eliminated);
      factor<W>(first, end);
      for (std::size_t row = end; row < matrix.size(); row += 4) subtract<W>(first, end, row);
    }
  }

private:
  template <int W> PDX_INLINE void factor(std::size_t first, std::size_t end) const
  {
    const std::size_t pitch = matrix.pitch();
    for (std::size_t k = first; k < end; ++k) {
      double* const row = matrix.row(k);
      if (!(row[k] > kSingular * diagonal[k])) {
        sound = false;
        return;
      }
      const double scale = 1.0 / std::sqrt(row[k]);
      for (std::size_t j = k; j < matrix.size(); ++j) row[j] *= scale;
      for (std::size_t i = k + 1; i < end; ++i) subtract_row<W>(row, row[i], matrix.row(i), i, pitch);
    }
  }

  /// What a panel takes of four rows.
  template <int W> PDX_INLINE void subtract(std::size_t first, std::size_t end, std::size_t row) const
  {
    constexpr int many = 4, wide = 2;
    const std::size_t pitch = matrix.pitch(), count = std::min<std::size_t>(many, matrix.size() - row);
    for (std::size_t j = row / (wide * W) * (wide * W); j < pitch; j += wide * W) {
      Lanes<W> sum[many][wide] = {};
      for (std::size_t k = first; k < end; ++k) {
        const double* const from = matrix.row(k);
        const Lanes<W> a = load<W>(from + j), b = load<W>(from + j + W);
        PDX_UNROLL
        for (std::size_t r = 0; r < many; ++r) { // rows behind the last one: padding, or nothing that is kept
          const double factor = from[std::min(row + r, pitch - 1)];
          sum[r][0] += factor * a;
          sum[r][1] += factor * b;
        }
      }
      for (std::size_t r = 0; r < count; ++r) {
        double* const to = matrix.row(row + r) + j;
        store<W>(load<W>(to) - sum[r][0], to);
        store<W>(load<W>(to + W) - sum[r][1], to + W);
      }
    }
  }
};
} // namespace

DenseElimination::DenseElimination(DenseSquare matrix, std::size_t eliminated)
    : matrix_(std::move(matrix)), eliminated_(eliminated)
{
  std::vector<double> diagonal;
  for (std::size_t k = 0; k < eliminated_; ++k) diagonal.push_back(matrix_.row(k)[k]);
  run_here(EliminatePanels{matrix_, eliminated_, diagonal, sound_});
}

std::vector<double> DenseElimination::schur() const
{
  const std::size_t size = left();
  std::vector<double> whole(size * size);
  for (std::size_t r = 0; r < size; ++r)
    for (std::size_t c = r; c < size; ++c)
      whole[r * size + c] = whole[c * size + r] = matrix_.row(eliminated_ + r)[eliminated_ + c];
  return whole;
}

void DenseElimination::condense(std::span<double> force) const
{
  for (std::size_t k = 0; k < eliminated_; ++k) {
    const double* const row = matrix_.row(k);
    force[k] /= row[k];
    for (std::size_t j = k + 1; j < matrix_.size(); ++j) force[j] -= row[j] * force[k];
  }
}

void DenseElimination::answer(std::span<double> x) const
{
  for (std::size_t k = eliminated_; k-- > 0;) {
    const double* const row = matrix_.row(k);
    double sum = x[k];
    for (std::size_t j = k + 1; j < matrix_.size(); ++j) sum -= row[j] * x[j];
    x[k] = sum / row[k];
  }
}
} // namespace pdx::solve
