#include "pdx/app/arguments.hpp"
#include "pdx/app/last_words.hpp"
#include "pdx/app/run.hpp"
#include "pdx/base/memory.hpp"
#include "pdx/base/petsc.hpp"

#include <cstdio>
#include <cstdlib>
#include <new>

namespace {
enum Exit { done = 0, user_error = 1, solver_failed = 2, machine_failed = 3 };

int report(const char* what, Exit code)
{
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank == 0) std::fprintf(stderr, "error: %s\n", what);
  return code;
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
  } catch (const std::bad_alloc&) {
    (void)pdx::app::LastWords::say(pdx::memory_ran_out());
  } catch (const std::exception& e) {
    (void)pdx::app::LastWords::say(e.what());
  }
  return pdx::app::LastWords::end();
}
} // namespace

int main(int argc, char** argv)
{
  const pdx::app::Arguments arguments = pdx::app::look_at_arguments(argc, argv);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return machine_failed;
  const double begin = MPI_Wtime();
  int code = done, rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  pdx::install_quiet_error_handler();
  pdx::app::LastWords::prepare(PETSC_COMM_WORLD);
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
