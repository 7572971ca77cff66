#include "pdx/solve/prolongation.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/petsc_version.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
template <std::size_t Dim> void interpolate(const field::Interpolation& p, const double* coarse, double* fine)
{
  for (std::size_t row = 0; row + 1 < p.offsets.size(); ++row) {
    double sum[Dim] = {};
    for (std::size_t k = p.offsets[row]; k < p.offsets[row + 1]; ++k)
      for (std::size_t a = 0; a < Dim; ++a)
        sum[a] += p.weights[k] * coarse[static_cast<std::size_t>(p.columns[k]) * Dim + a];
    for (std::size_t a = 0; a < Dim; ++a) fine[row * Dim + a] = sum[a];
  }
}

template <std::size_t Dim> void accumulate(const field::Interpolation& p, const double* fine, double* coarse)
{
  for (std::size_t row = 0; row + 1 < p.offsets.size(); ++row)
    for (std::size_t k = p.offsets[row]; k < p.offsets[row + 1]; ++k)
      for (std::size_t a = 0; a < Dim; ++a)
        coarse[static_cast<std::size_t>(p.columns[k]) * Dim + a] += p.weights[k] * fine[row * Dim + a];
}
} // namespace

Prolongation::Prolongation(const field::System& system, const field::CoarseSpace& coarse)
    : system_(system), coarse_(coarse)
{
  const PetscInt fine = system.rows.dim * system.rows.owned(), below = system.rows.dim * coarse.halo().rows().owned();
  const auto make = [&](MatHandle& shell, PetscInt rows, PetscInt columns, auto multiply, auto multiply_transpose) {
    PDX_CALL(MatCreateShell(system.rows.comm, rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, this, shell.out()));
    PDX_CALL(MatShellSetOperation(shell.get(), MATOP_MULT, reinterpret_cast<void (*)()>(multiply)));
    PDX_CALL(MatShellSetOperation(shell.get(), MATOP_MULT_TRANSPOSE, reinterpret_cast<void (*)()>(multiply_transpose)));
  };
  make(prolongation_, fine, below, prolong, restrict_to);
  const bool square = coarse.halo().rows().total == system.rows.total;
  if (!square || !restricts_by_transpose()) make(restriction_, below, fine, restrict_to, prolong);
}

void Prolongation::mask(double* fine) const
{
  for (const Index k : system_.prescribed.components) fine[k] = 0.0;
}

/// Residuals at prescribed components are none of the coarse level's business.
void Prolongation::take_back_prescribed(const double* fine)
{
  const auto dim = static_cast<std::size_t>(system_.rows.dim);
  const auto& p = coarse_.interpolation();
  for (const Index component : system_.prescribed.components) {
    const auto row = static_cast<std::size_t>(component) / dim, a = static_cast<std::size_t>(component) % dim;
    for (std::size_t k = p.offsets[row]; k < p.offsets[row + 1]; ++k)
      work_[static_cast<std::size_t>(p.columns[k]) * dim + a] -= p.weights[k] * fine[component];
  }
}

PetscErrorCode Prolongation::prolong(Mat shell, Vec coarse, Vec fine)
{
  return guard([&] {
    static Event event("solve_prolong");
    Timed timed(event);
    Prolongation* self = nullptr;
    PDX_CALL(MatShellGetContext(shell, &self));
    self->coarse_.halo().gather(coarse, self->work_);
    double* to = nullptr;
    PDX_CALL(VecGetArrayWrite(fine, &to));
    const auto& p = self->coarse_.interpolation();
    self->system_.rows.dim == 2 ? interpolate<2>(p, self->work_.data(), to) : interpolate<3>(p, self->work_.data(), to);
    self->mask(to);
    PDX_CALL(VecRestoreArrayWrite(fine, &to));
  });
}

PetscErrorCode Prolongation::restrict_to(Mat shell, Vec fine, Vec coarse)
{
  return guard([&] {
    static Event event("solve_restrict");
    Timed timed(event);
    Prolongation* self = nullptr;
    PDX_CALL(MatShellGetContext(shell, &self));
    const int dim = self->system_.rows.dim;
    const field::RowHalo& halo = self->coarse_.halo();
    self->work_.assign(static_cast<std::size_t>(halo.size() * dim), 0.0);
    const double* from = nullptr;
    PDX_CALL(VecGetArrayRead(fine, &from));
    const auto& p = self->coarse_.interpolation();
    dim == 2 ? accumulate<2>(p, from, self->work_.data()) : accumulate<3>(p, from, self->work_.data());
    self->take_back_prescribed(from);
    PDX_CALL(VecRestoreArrayRead(fine, &from));
    halo.reduce(self->work_, dim);
    double* to = nullptr;
    PDX_CALL(VecGetArrayWrite(coarse, &to));
    std::copy_n(self->work_.begin(), static_cast<std::size_t>(halo.rows().owned() * dim), to);
    PDX_CALL(VecRestoreArrayWrite(coarse, &to));
  });
}
} // namespace pdx::solve
