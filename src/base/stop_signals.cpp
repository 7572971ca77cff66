#include "pdx/base/stop_signals.hpp"

#include <algorithm>
#include <string>

namespace pdx {
namespace {
constexpr std::array kSignals{SIGTERM, SIGUSR1, SIGINT, SIGHUP};
constexpr std::array kNames{"SIGTERM", "SIGUSR1", "SIGINT", "SIGHUP"};
constexpr double kSeconds = 0.25;  // from one look to the next [s]
constexpr double kMostCalls = 1e3; // likewise

volatile std::sig_atomic_t noted = 0;

void note(int sig) { noted = sig; }

std::array<bool, 4> ignored{};
bool looked = false;

[[noreturn]] void stop(int sig) { throw Stopped(std::string("stopped by ") + StopSignals::name(sig)); }
} // namespace

void StopSignals::look_at_ignored()
{
  if (looked) return;
  looked = true;
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    struct sigaction now {};
    sigaction(kSignals[k], nullptr, &now);
    ignored[k] = now.sa_handler == SIG_IGN;
  }
}

StopSignals::StopSignals()
{
  look_at_ignored();
  for (std::size_t k = 0; k < kSignals.size(); ++k) {
    struct sigaction action {};
    action.sa_handler = ignored[k] ? SIG_IGN : note;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(kSignals[k], &action, &before_[k]);
  }
}

StopSignals::~StopSignals()
{
  for (std::size_t k = 0; k < kSignals.size(); ++k) sigaction(kSignals[k], &before_[k], nullptr);
}

int StopSignals::caught() { return noted; }

const char* StopSignals::name(int sig)
{
  const auto* const at = std::ranges::find(kSignals, sig);
  return at == kSignals.end() ? "a signal" : kNames[static_cast<std::size_t>(at - kSignals.begin())];
}

void stop_if_told(MPI_Comm comm)
{
  if (NoStop::any()) return;
  int sig = StopSignals::caught();
  MPI_Allreduce(MPI_IN_PLACE, &sig, 1, MPI_INT, MPI_MAX, comm);
  if (sig) stop(sig);
}

void StopLook::operator()()
{
  if (++calls_ < next_) return;
  const double now = MPI_Wtime();
  double all[] = {static_cast<double>(StopSignals::caught()), looked_ > 0.0 ? (now - looked_) / calls_ : kSeconds};
  MPI_Allreduce(MPI_IN_PLACE, all, 2, MPI_DOUBLE, MPI_MAX, comm_);
  if (all[0] > 0.0) stop(static_cast<int>(all[0]));
  next_ = static_cast<int>(std::clamp(kSeconds / std::max(all[1], 1e-9), 1.0, kMostCalls));
  calls_ = 0;
  looked_ = now;
}
} // namespace pdx
