#include "pdx/record/last_words.hpp"

#include "pdx/base/memory.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/io/run_lock.hpp"

#include <csignal>
#include <cstdlib>
#include <unistd.h>

namespace pdx::record {
namespace {
constexpr int kStatus = 3;
constexpr double kPatience = 1.0;  // for other ranks to fail alike [s]
constexpr unsigned kGrace = 4;     // for an orderly end [s]
MPI_Comm ranks = MPI_COMM_NULL;    // for the end alone
bool said = false, speaks = false; // by this rank, for all
bool together = false;             // all ranks have failed

void end_now(int)
{
  static constexpr char line[] = "error: memory ran out\n";
  if (!said) (void)!write(STDERR_FILENO, line, sizeof line - 1);
  io::RunLock::drop();
  _exit(kStatus);
}

/// Nobody waits for more than this: neither for ranks that do not know, nor for what ends objects in order.
void limit_time() noexcept
{
  std::signal(SIGALRM, end_now);
  alarm(kGrace);
}

void print(const std::string& why)
{
  const std::string line = "error: " + as_one_line(why) + "\n";
  (void)!write(STDERR_FILENO, line.data(), line.size());
}

void mpi_failed(MPI_Comm*, int* code, ...)
{
  char reason[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(*code, reason, &length);
  for (int k = 0; k < length; ++k)
    if (reason[k] == '\n') reason[k] = ' ';
  print(std::string("MPI failed, a rank or the network may be lost: ") + reason);
  io::RunLock::drop();
  MPI_Abort(MPI_COMM_WORLD, kStatus);
}

bool all_are_here()
{
  int size = 1, here = 0;
  if (ranks == MPI_COMM_NULL) return false;
  MPI_Comm_size(ranks, &size);
  if (size == 1) return true;
  MPI_Request barrier = MPI_REQUEST_NULL;
  if (MPI_Ibarrier(ranks, &barrier) != MPI_SUCCESS) return false;
  for (const double begin = MPI_Wtime(); !here && MPI_Wtime() - begin < kPatience; usleep(1000))
    if (MPI_Test(&barrier, &here, MPI_STATUS_IGNORE) != MPI_SUCCESS) return false;
  return here != 0;
}
} // namespace

void LastWords::prepare(MPI_Comm comm)
{
  keep_memory_reserve(limit_time);
  std::signal(SIGXFSZ, SIG_IGN); // the write says so
  std::signal(SIGPIPE, SIG_IGN); // nobody reads our words: no reason to stop
  MPI_Errhandler handler = MPI_ERRHANDLER_NULL;
  MPI_Comm_create_errhandler(mpi_failed, &handler);
  MPI_Comm_set_errhandler(comm, handler);
  MPI_Errhandler_free(&handler);
  MPI_Comm_dup(comm, &ranks);
  MPI_Comm_set_errhandler(ranks, MPI_ERRORS_RETURN);
}

bool LastWords::say(const std::string& why)
{
  if (said) return speaks;
  said = true;
  limit_time();
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  speaks = rank == 0;
  if (speaks) print(why);
  together = all_are_here();
  if (!together && !speaks) {
    speaks = true;
    print(why);
  }
  return speaks;
}

int LastWords::end()
{
  if (!together) {
    io::RunLock::drop();
    MPI_Abort(MPI_COMM_WORLD, kStatus);
  }
  return kStatus;
}

void LastWords::spare()
{
  if (!said && ranks != MPI_COMM_NULL) MPI_Comm_free(&ranks);
}
} // namespace pdx::record
