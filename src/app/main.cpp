#include "pdx/app/arguments.hpp"
#include "pdx/app/run.hpp"
#include "pdx/base/petsc.hpp"

#include <cstdio>
#include <cstdlib>

namespace {
enum Exit { done = 0, user_error = 1, solver_failed = 2, broken = 3 };

int report(const char* what, Exit code)
{
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) std::fprintf(stderr, "error: %s\n", what);
  return code;
}

/// Waits a moment for the others: a failure of PETSc meets either all ranks, which then end together, or one alone,
/// for which nobody may wait.
bool all_ranks_are_here()
{
  constexpr double kPatience = 3.0; // [s]
  MPI_Request barrier = MPI_REQUEST_NULL;
  int here = 0;
  MPI_Ibarrier(PETSC_COMM_WORLD, &barrier);
  for (const double begin = MPI_Wtime(); !here && MPI_Wtime() - begin < kPatience;)
    MPI_Test(&barrier, &here, MPI_STATUS_IGNORE);
  return here != 0;
}

int solve(double begin)
{
  try {
    pdx::app::run(PETSC_COMM_WORLD, begin);
    return done;
  } catch (const pdx::UserError& e) {
    return report(e.what(), user_error);
  } catch (const pdx::SolverFailure& e) {
    return report(e.what(), solver_failed);
  } catch (const std::exception& e) {
    if (all_ranks_are_here()) return report(e.what(), broken);
    std::fprintf(stderr, "error: %s\n", e.what());
    MPI_Abort(PETSC_COMM_WORLD, broken);
    return broken;
  }
}
} // namespace

int main(int argc, char** argv)
{
  const pdx::app::Arguments arguments = pdx::app::look_at_arguments(argc, argv);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return broken;
  const double begin = MPI_Wtime();
  int code = done, rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  pdx::install_quiet_error_handler();
  if (!arguments.error.empty())
    code = report(arguments.error.c_str(), user_error);
  else if (arguments.help || arguments.version) {
    if (rank == 0) arguments.help ? pdx::app::print_help() : pdx::app::print_version();
  } else
    code = solve(begin);
  (void)PetscOptionsSetValue(nullptr, "-options_left", "no");
  (void)PetscPopErrorHandler();
  (void)PetscFinalize();
  return code;
}
