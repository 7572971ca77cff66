#include "pdx/app/stop_signals.hpp"

namespace pdx::app {
namespace {
volatile std::sig_atomic_t noted = 0;

void note(int sig) { noted = sig; }
} // namespace

StopSignals::StopSignals()
{
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTERM, &action, &term_);
  sigaction(SIGUSR1, &action, &usr1_);
}

StopSignals::~StopSignals()
{
  sigaction(SIGTERM, &term_, nullptr);
  sigaction(SIGUSR1, &usr1_, nullptr);
}

int StopSignals::caught() { return noted; }

const char* StopSignals::name(int sig) { return sig == SIGUSR1 ? "SIGUSR1" : "SIGTERM"; }
} // namespace pdx::app
