#include "pdx/app/run.hpp"
#include "pdx/base/given_options.hpp"
#include "pdx/base/memory.hpp"
#include "pdx/base/petsc.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/options/arguments.hpp"
#include "pdx/options/help.hpp"
#include "pdx/record/last_words.hpp"

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

namespace {
enum Exit { done = 0, user_error = 1, solver_failed = 2, machine_failed = 3 };

int report(const std::string& what, Exit code)
{
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0) std::fprintf(stderr, "error: %s\n", pdx::as_one_line(pdx::with_place(what)).c_str());
  return code;
}

/// Waits a moment for the others: a failure of PETSc meets either all ranks, which then end together, or one alone,
/// for which nobody may wait.
bool all_ranks_are_here()
{
  constexpr double kPatience = 3.0; // [s]
  MPI_Request barrier = MPI_REQUEST_NULL;
  int here = 0;
  MPI_Ibarrier(MPI_COMM_WORLD, &barrier);
  for (const double begin = MPI_Wtime(); !here && MPI_Wtime() - begin < kPatience;)
    MPI_Test(&barrier, &here, MPI_STATUS_IGNORE);
  return here != 0;
}

/// What may have met this rank alone: then the others, who wait for it, are ended.
int report_alone(const std::string& what, Exit code)
{
  if (all_ranks_are_here()) return report(what, code);
  std::fprintf(stderr, "error: %s\n", pdx::as_one_line(pdx::with_place(what)).c_str());
  MPI_Abort(MPI_COMM_WORLD, code);
  return code;
}

/// The exit status of `body`, whose failures are told.
template <class Body> int reported(Body&& body)
{
  try {
    body();
    return done;
  } catch (const pdx::UserError& e) {
    return report(e.what(), user_error);
  } catch (const pdx::SolverFailure& e) {
    return report(e.what(), solver_failed);
  } catch (const std::bad_alloc&) {
    (void)pdx::record::LastWords::say(pdx::memory_ran_out());
  } catch (const std::exception& e) {
    (void)pdx::record::LastWords::say(e.what());
  }
  return pdx::record::LastWords::end();
}

/// Why PETSc does not start or end, "" if it does: the value of one of its options as a rule.
std::string start_petsc()
{
  static std::string program = "pdxsolve", skip = "-skip_petscrc"; // PETSc keeps the pointers
  static std::array<char*, 3> words{program.data(), skip.data(), nullptr};
  char** arguments = words.data();
  int count = 2;
  pdx::install_quiet_error_handler();
  if (!PetscInitialize(&count, &arguments, nullptr, nullptr)) return "";
  return pdx::take_petsc_message() + std::string(pdx::kPetscValue);
}

std::string end_petsc()
{
  (void)PetscOptionsSetValue(nullptr, "-options_left", "no");
  return PetscFinalize() ? pdx::take_petsc_message() + std::string(pdx::kPetscValue) : "";
}

void tell(const pdx::options::Arguments& arguments)
{
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const std::string text = !arguments.help  ? pdx::options::version_text()
                           : arguments.json ? pdx::options::help_json()
                                            : pdx::options::help_text(arguments.help_words);
  if (rank == 0) std::fputs(text.c_str(), stdout);
}

int run_program(const pdx::options::Arguments& arguments)
{
  if (!arguments.error.empty()) return report(arguments.error, user_error);
  if (const int code = reported(pdx::options::hand_options_to_petsc)) return code;
  if (const std::string fault = start_petsc(); !fault.empty()) return report(fault, user_error);
  const pdx::StopSignals signals; // again, for PETSc has handlers of its own
  pdx::record::LastWords::prepare(PETSC_COMM_WORLD);
  const double begin = MPI_Wtime();
  const int code = reported([&] {
    if (arguments.help || arguments.version) return tell(arguments);
    pdx::app::run(PETSC_COMM_WORLD, begin);
  });
  const std::string late = end_petsc();
  pdx::record::LastWords::spare();
  return late.empty() ? code : report_alone(late, code == done ? user_error : static_cast<Exit>(code));
}
} // namespace

namespace {
void before_libraries(int, char**, char**) { pdx::StopSignals::look_at_ignored(); }
[[gnu::section(".preinit_array"), gnu::used]] void (*const first)(int, char**, char**) = before_libraries;

/// One process without a launcher needs no daemon: Open MPI 4 starts one, and now and then ends with a signal as it
/// leaves it.
void need_no_daemon()
{
  for (const char* launched : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"})
    if (std::getenv(launched)) return;
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
}
} // namespace

int main(int argc, char** argv)
{
  need_no_daemon();
  std::signal(SIGXFSZ, SIG_IGN); // MPI writes files too, and says so where it cannot
  const pdx::StopSignals signals;
  int threads = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &threads);
  const int code = run_program(pdx::options::read_arguments(MPI_COMM_WORLD, argc, argv));
  MPI_Finalize();
  return code;
}
