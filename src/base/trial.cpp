#include "pdx/base/trial.hpp"

#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pdx {
namespace {
constexpr int kThrew = 17; // exit status

[[noreturn]] void run_apart(const std::function<void()>& body, unsigned seconds)
{
  for (const int sig : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGTERM, SIGINT}) std::signal(sig, SIG_DFL);
  const rlimit none{0, 0};
  (void)setrlimit(RLIMIT_CORE, &none);
  if (const int quiet = open("/dev/null", O_WRONLY); quiet >= 0) (void)dup2(quiet, STDERR_FILENO);
  alarm(seconds);
  try {
    body();
  } catch (...) {
    _exit(kThrew);
  }
  _exit(0);
}
} // namespace

std::string try_apart(const std::function<void()>& body, unsigned seconds)
{
  const pid_t child = fork();
  if (child == 0) run_apart(body, seconds);
  if (child < 0) return ""; // no process to spare: it is done here without a trial
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) return "";
  if (WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == kThrew)) return ""; // throws here too
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return fmt::format("it takes longer than {} s", seconds);
  return "HDF5 crashes on it";
}
} // namespace pdx
