#pragma once
#include <cstdio>
#include <mpi.h>
#include <span>
#include <string>
#include <string_view>

namespace pdx::io {
/// Seconds as a person reads them: "1.5 s", "2 min 05 s", "3 h 07 min".
std::string duration(double seconds);

/// A part of the run in the closing table.
struct Phase {
  std::string name;
  double seconds = 0.0; ///< wall time [s]
  std::string rate;     ///< the rate that matters, e.g. "1.2e9 bonds/s"; may be empty
};

/// Tells a waiting human how far the run is. On a terminal a bar redrawn in place; in a batch log a short line at
/// most every few seconds, and the last one. Rank 0 speaks, the others are silent; nothing here is collective.
class Progress {
public:
  Progress(MPI_Comm comm, bool quiet);
  /// @param out a stream to speak to   @param interval least time between two lines of a batch log [s]
  Progress(bool quiet, std::FILE* out, double interval);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// False if a word about step `step` of `steps` is too soon, and not worth its text.
  bool due(int step, int steps) const;
  /// Step `step` (from 1) of `steps` is done; `steps` 0 if unknown. `text` says what matters now.
  void step(int step, int steps, std::string_view text);
  /// A line that stays: a notice between steps.
  void line(std::string_view text);
  /// The closing table: each phase with its share of the sum.
  void phases(std::span<const Phase> phases);

private:
  void draw_bar(int step, int steps, std::string_view text);
  void end_bar();
  std::string remaining(int step, int steps) const;

  std::FILE* out_;           ///< null: say nothing
  bool terminal_;            ///< a person watches
  bool bar_ = false;         ///< a bar stands on the current line
  double interval_;          ///< [s]
  double start_, last_line_; ///< wall clock [s]
};
} // namespace pdx::io
