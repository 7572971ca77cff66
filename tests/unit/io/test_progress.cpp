#include "pdx/io/progress.hpp"

#include <array>
#include <cstdlib>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sstream>
#include <sys/ioctl.h>
#include <unistd.h>
#include <vector>

namespace {
using pdx::io::Progress;

/// A stream that is no terminal, and what was written to it.
class Log {
public:
  Log() : file_(std::tmpfile()) {}
  ~Log() { std::fclose(file_); }
  std::FILE* stream() { return file_; }
  std::vector<std::string> lines()
  {
    std::rewind(file_);
    std::vector<std::string> all(1);
    for (int c = std::fgetc(file_); c != EOF; c = std::fgetc(file_)) {
      if (c == '\n')
        all.emplace_back();
      else
        all.back() += static_cast<char>(c);
    }
    all.pop_back();
    return all;
  }

private:
  std::FILE* file_;
};

/// A terminal nobody looks at, and what was drawn on it.
class Terminal {
public:
  Terminal() : master_(posix_openpt(O_RDWR | O_NOCTTY))
  {
    grantpt(master_);
    unlockpt(master_);
    const winsize size{24, 80, 0, 0}; // a terminal without columns counts as none
    ioctl(master_, TIOCSWINSZ, &size);
    slave_ = std::fopen(ptsname(master_), "w");
  }
  ~Terminal()
  {
    std::fclose(slave_);
    close(master_);
  }
  std::FILE* stream() { return slave_; }
  std::string shown()
  {
    std::array<char, 4096> text{};
    const auto n = read(master_, text.data(), text.size());
    return {text.data(), static_cast<std::size_t>(n > 0 ? n : 0)};
  }

private:
  int master_;
  std::FILE* slave_ = nullptr;
};
constexpr double kNever = 1e9; // [s]
} // namespace

TEST(Progress, BatchLogGetsOnlyTheLastLineOfAFastRun)
{
  Log log;
  Progress progress(false, log.stream(), kNever);
  for (int step = 1; step <= 100; ++step) progress.step(step, 100, "load 1");
  EXPECT_EQ(log.lines(), (std::vector<std::string>{"step 100/100  load 1"}));
}

TEST(Progress, BatchLogGetsALineWheneverTheIntervalIsOver)
{
  Log log;
  Progress progress(false, log.stream(), 0.0);
  for (int step = 1; step <= 3; ++step) progress.step(step, 3, "");
  const auto lines = log.lines();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].find("step 1/3"), 0u);
  EXPECT_NE(lines[0].find("left"), std::string::npos);
  EXPECT_EQ(lines[2].find("left"), std::string::npos);
}

TEST(Progress, QuietSaysNothing)
{
  Log log;
  Progress progress(true, log.stream(), 0.0);
  progress.step(1, 1, "load 1");
  progress.line("notice");
  const std::vector<pdx::io::Phase> phases{{"solve", 1.0, ""}};
  progress.phases(phases);
  EXPECT_TRUE(log.lines().empty());
}

TEST(Progress, TerminalGetsABarRedrawnInPlace)
{
  Terminal terminal;
  Progress progress(false, terminal.stream(), kNever);
  progress.step(1, 2, "load 0.5");
  const std::string half = terminal.shown();
  EXPECT_NE(half.find("\r\x1b[2K[############............] 1/2  load 0.5"), std::string::npos) << half;
  EXPECT_EQ(half.find('\n'), std::string::npos);
  progress.step(2, 2, "load 1");
  EXPECT_NE(terminal.shown().find("\r\x1b[2K[########################] 2/2  load 1"), std::string::npos);
}

TEST(Progress, PhaseTableSharesOutTheWholeTime)
{
  Log log;
  Progress progress(false, log.stream(), kNever);
  const std::vector<pdx::io::Phase> phases{{"setup", 1.0, ""}, {"solve", 3.0, "2e5 unknowns/s"}};
  progress.phases(phases);
  const auto lines = log.lines();
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_NE(lines[0].find("25.0 %"), std::string::npos);
  EXPECT_NE(lines[1].find("75.0 %  2e5 unknowns/s"), std::string::npos);
  EXPECT_NE(lines[2].find("4.000 s"), std::string::npos);
  EXPECT_NE(lines[2].find("100.0 %"), std::string::npos);
}
