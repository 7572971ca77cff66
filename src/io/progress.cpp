#include "pdx/io/progress.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace pdx::io {
namespace {
constexpr double kLogInterval = 5.0;   // [s]
constexpr double kBarInterval = 0.1;   // [s]
constexpr std::size_t kBarLength = 24; // characters
constexpr const char* kClearLine = "\r\x1b[2K";

double now()
{
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

bool is_first(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank == 0;
}

/// Columns of the terminal a person looks at, 0 if there is none: mpirun gives its ranks a terminal without columns,
/// whose text may end in a batch log.
std::size_t terminal_width(std::FILE* out)
{
  winsize size{};
  return isatty(fileno(out)) == 1 && ioctl(fileno(out), TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}
} // namespace

std::string duration(double seconds)
{
  const auto s = std::lround(seconds);
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02d} s", s / 60, s % 60);
  return fmt::format("{} h {:02d} min", s / 3600, s % 3600 / 60);
}

Progress::Progress(MPI_Comm comm, bool quiet) : Progress(quiet || !is_first(comm), stdout, kLogInterval) {}

Progress::Progress(bool quiet, std::FILE* out, double interval)
    : out_(quiet ? nullptr : out), terminal_(out_ && terminal_width(out) > 0), interval_(interval), start_(now()),
      last_line_(start_)
{}

Progress::~Progress() { end_bar(); }

void Progress::end_bar()
{
  if (!bar_) return;
  std::fputc('\n', out_);
  std::fflush(out_);
  bar_ = false;
}

std::string Progress::remaining(int step, int steps) const
{
  if (step <= 0 || steps <= step) return "";
  return "  left " + duration((now() - start_) / step * (steps - step));
}

void Progress::draw_bar(int step, int steps, std::string_view text)
{
  std::string shown;
  if (steps > 0) {
    const auto done =
        kBarLength * static_cast<std::size_t>(std::clamp(step, 0, steps)) / static_cast<std::size_t>(steps);
    shown = "[" + std::string(done, '#') + std::string(kBarLength - done, '.') + "] ";
  }
  shown += fmt::format("{}{}  {}{}", step, steps > 0 ? fmt::format("/{}", steps) : "", text, remaining(step, steps));
  shown.resize(std::min(shown.size(), terminal_width(out_) - 1));
  fmt::print(out_, "{}{}", kClearLine, shown);
  std::fflush(out_);
  bar_ = true;
  last_line_ = now();
}

bool Progress::due(int step, int steps) const
{
  if (!out_) return false;
  const bool last = steps > 0 && step >= steps;
  return last || now() - last_line_ >= (terminal_ ? kBarInterval : interval_);
}

void Progress::step(int step, int steps, std::string_view text)
{
  if (!out_) return;
  if (terminal_) return draw_bar(step, steps, text);
  if (!due(step, steps)) return;
  last_line_ = now();
  fmt::print(out_, "step {}{}  {}{}\n", step, steps > 0 ? fmt::format("/{}", steps) : "", text, remaining(step, steps));
  std::fflush(out_);
}

void Progress::line(std::string_view text)
{
  if (!out_) return;
  if (bar_) std::fputs(kClearLine, out_);
  bar_ = false;
  fmt::print(out_, "{}\n", text);
  std::fflush(out_);
}

void Progress::phases(std::span<const Phase> phases)
{
  if (!out_) return;
  end_bar();
  double total = 0.0;
  std::size_t width = 5;
  for (const Phase& phase : phases) {
    total += phase.seconds;
    width = std::max(width, phase.name.size());
  }
  const auto print = [&](std::string_view name, double seconds, std::string_view rate) {
    const double share = total > 0.0 ? 100.0 * seconds / total : 0.0;
    fmt::print(out_, "{:<{}} {:>10.3f} s {:>6.1f} %{}{}\n", name, width, seconds, share, rate.empty() ? "" : "  ",
               rate);
  };
  for (const Phase& phase : phases) print(phase.name, phase.seconds, phase.rate);
  print("total", total, "");
  std::fflush(out_);
}
} // namespace pdx::io
