#pragma once
#include <mpi.h>
#include <string>

namespace pdx::record {
/// How a run ends when the machine fails one rank or all of them: exit status 3.
class LastWords {
public:
  /// Once, at the start: memory for the end, a communicator for it, and signals of a full disk that would kill. A lost
  /// rank that MPI tells of ends the run too. Collective.
  static void prepare(MPI_Comm comm);
  /// Says why on standard error, once in all: the rank that speaks for all is rank 0, or one that fails while others go
  /// on. True on that rank. Not collective; nobody is waited for longer than a moment.
  static bool say(const std::string& why);
  /// Exit status 3 if every rank has said its last words; else ends all of them and does not return.
  static int end();
  /// Gives back what `prepare` took, where nobody had to speak. Collective.
  static void spare();
};
} // namespace pdx::record
