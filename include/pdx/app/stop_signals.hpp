#pragma once
#include <csignal>

namespace pdx::app {
/// While alive, SIGTERM and SIGUSR1 (what batch systems send before they kill) are only noted, on this rank.
class StopSignals {
public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  static int caught();              ///< 0: none
  static const char* name(int sig); ///< "SIGTERM"

private:
  struct sigaction term_ {
  }, usr1_{}; // what was there before
};
} // namespace pdx::app
