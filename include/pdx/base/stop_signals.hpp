#pragma once
#include <array>
#include <csignal>
#include <mpi.h>
#include <stdexcept>

namespace pdx {
/// A signal ends the run, which is no failure; thrown by every rank alike. Exit status 0.
struct Stopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// While alive, the signals by which users and batch systems end a run (TERM, USR1, INT, HUP) are only noted, on this
/// rank. One that was ignored (nohup) when `look_at_ignored` was called, or the first of these objects was made, stays
/// so.
class StopSignals {
public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// For the very start: libraries put handlers of their own in place before main (UCX on SIGHUP).
  static void look_at_ignored();
  static int caught();              ///< 0: none
  static const char* name(int sig); ///< "SIGTERM"

private:
  std::array<struct sigaction, 4> before_{}; // what was there
};

/// Throws Stopped if any rank has caught a signal. Collective.
void stop_if_told(MPI_Comm comm);

/// While alive `stop_if_told` does nothing: where what a run has come to stands in no object that could save it. Alike
/// on every rank.
class NoStop {
public:
  NoStop() { ++alive_; }
  ~NoStop() { --alive_; }
  NoStop(const NoStop&) = delete;
  NoStop& operator=(const NoStop&) = delete;
  static bool any() { return alive_ > 0; }

private:
  static inline int alive_ = 0;
};

/// The same for inner loops, where most calls do nothing: ranks look together about four times a second.
class StopLook {
public:
  explicit StopLook(MPI_Comm comm) : comm_(comm) {}
  void operator()();

private:
  MPI_Comm comm_;
  int calls_ = 0, next_ = 1; // since the last look, and at which to look again
  double looked_ = 0.0;      // wall clock [s]
};
} // namespace pdx
