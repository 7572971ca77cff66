#include "support/pulled.hpp"
#include "support/springs.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// A coarse space that gets one more row on each rank, tied to nothing, when it is first rebuilt.
class GrowingCoarse final : public field::CoarseSpace {
public:
  explicit GrowingCoarse(std::unique_ptr<field::CoarseSpace> inner) : inner_(std::move(inner)) {}
  const field::RowHalo& halo() const override { return halo_ ? *halo_ : inner_->halo(); }
  const field::Interpolation& interpolation() const override
  {
    return halo_ ? interpolation_ : inner_->interpolation();
  }
  std::vector<double> coordinates() const override
  {
    std::vector<double> all = inner_->coordinates();
    if (halo_) all.insert(all.end(), {0.5, 0.5});
    return all;
  }
  bool rebuild() override
  {
    if (halo_) return false;
    const field::Rows& old = inner_->halo().rows();
    int ranks = 0;
    MPI_Comm_size(old.comm, &ranks);
    firsts_.resize(static_cast<std::size_t>(ranks));
    MPI_Allgather(&old.first, 1, MPIU_INT, firsts_.data(), 1, MPIU_INT, old.comm);
    std::vector<PetscInt> needed;
    for (Index row = old.owned(); row < inner_->halo().size(); ++row)
      needed.push_back(moved(inner_->halo().global(row)));
    halo_ = std::make_unique<field::RowHalo>(field::Rows::number(old.comm, 2, old.owned() + 1, 0, 0), needed);
    interpolation_ = inner_->interpolation();
    for (Index& column : interpolation_.columns) column += column >= old.owned();
    return true;
  }
  MatHandle assemble(std::span<const double> u) override
  {
    MatHandle small = inner_->assemble(u);
    if (!halo_) return small;
    const field::Rows &old = inner_->halo().rows(), &rows = halo_->rows();
    MatHandle large;
    PDX_CALL(MatCreateAIJ(rows.comm, 2 * rows.owned(), 2 * rows.owned(), PETSC_DETERMINE, PETSC_DETERMINE, 40, nullptr,
                          40, nullptr, large.out()));
    PDX_CALL(MatSetBlockSize(large.get(), 2));
    for (PetscInt row = 2 * old.first; row < 2 * (old.first + old.owned()); ++row) {
      const PetscInt* columns = nullptr;
      const double* values = nullptr;
      PetscInt n = 0;
      PDX_CALL(MatGetRow(small.get(), row, &n, &columns, &values));
      for (PetscInt k = 0; k < n; ++k)
        PDX_CALL(MatSetValue(large.get(), 2 * moved(row / 2) + row % 2, 2 * moved(columns[k] / 2) + columns[k] % 2,
                             values[k], INSERT_VALUES));
      PDX_CALL(MatRestoreRow(small.get(), row, &n, &columns, &values));
    }
    for (PetscInt a = 2 * (rows.first + old.owned()); a < 2 * (rows.first + rows.owned()); ++a)
      PDX_CALL(MatSetValue(large.get(), a, a, 1.0, INSERT_VALUES));
    PDX_CALL(MatAssemblyBegin(large.get(), MAT_FINAL_ASSEMBLY));
    PDX_CALL(MatAssemblyEnd(large.get(), MAT_FINAL_ASSEMBLY));
    return large;
  }

private:
  /// The new number of an old row: each rank before its own put one more in.
  PetscInt moved(PetscInt row) const
  {
    return row + static_cast<PetscInt>(std::upper_bound(firsts_.begin(), firsts_.end(), row) - firsts_.begin()) - 1;
  }

  std::unique_ptr<field::CoarseSpace> inner_;
  std::unique_ptr<field::RowHalo> halo_;
  field::Interpolation interpolation_;
  std::vector<PetscInt> firsts_;
};

struct Solved {
  VecHandle u;
  solve::StaticReport report;
  PetscInt coarse_size = 0, smoothings = 0;
};

/// A clamped strip of particles on a few springs that break at load 1.
Solved solve_strip(bool growing)
{
  test::Scene scene(test::pulled_particles(24, {3e-2, 1e-2}));
  field::System& system = scene.system();
  std::vector<test::Spring> springs;
  for (Index row = 0; row < scene.rows().owned(); ++row)
    if (scene.place(row).x() > 0.9) springs.push_back({row, {1.0, 0.0}, 0.01, 5e-3});
  system.terms.push_back(std::make_unique<test::Springs>(springs));
  system.after.push_back(std::make_unique<test::SpringBreaker>(springs, scene.rows().comm));
  if (growing) system.coarse = std::make_unique<GrowingCoarse>(std::move(system.coarse));
  Solved solved;
  solved.u = scene.rows().vector();
  solve::StaticDriver driver(system, {.load_steps = 1, .rebuild_factor = 0.0});
  driver.run(solved.u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
  solved.report = driver.report();
  KSP ksp = nullptr;
  PC pc = nullptr;
  Mat matrix = nullptr;
  PDX_CALL(SNESGetKSP(driver.snes(), &ksp));
  PDX_CALL(KSPGetPC(ksp, &pc));
  PDX_CALL(PCMGGetSmoother(pc, 1, &ksp));
  PDX_CALL(KSPGetTolerances(ksp, nullptr, nullptr, nullptr, &solved.smoothings));
  PDX_CALL(PCMGGetCoarseSolve(pc, &ksp));
  PDX_CALL(KSPGetOperators(ksp, &matrix, nullptr));
  PDX_CALL(MatGetSize(matrix, &solved.coarse_size, nullptr));
  return solved;
}
} // namespace

TEST(CoarseRebuild, TakesRowsThatChangedAndKeepsOptionsOfTheLevels)
{
  const test::Option smoothings("-mg_levels_ksp_max_it", "3");
  const Solved plain = solve_strip(false), grown = solve_strip(true);
  int ranks = 0;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  EXPECT_GE(plain.report.preconditioner_builds, 2);
  EXPECT_EQ(grown.report.preconditioner_builds, plain.report.preconditioner_builds);
  EXPECT_EQ(grown.coarse_size, plain.coarse_size + 2 * ranks);
  EXPECT_EQ(plain.smoothings, 3);
  EXPECT_EQ(grown.smoothings, 3);
  EXPECT_LE(std::abs(grown.report.linear_iterations - plain.report.linear_iterations), 2);
  EXPECT_LT(test::difference(grown.u.get(), plain.u.get(), NORM_2), 1e-8);
}
