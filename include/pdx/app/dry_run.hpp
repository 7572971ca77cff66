#pragma once
#include "pdx/app/run_files.hpp"

namespace pdx::app {
/// What `-dry_run` finds out of a run whose scene stands: what its parts take, and with that the whole of it. All
/// methods are collective.
class DryRun {
public:
  explicit DryRun(RunFiles& files) : files_(files) {}

  /// Writes the initial fields and times that.
  void fields(double time, Vec u);
  /// Asked after each step that is timed: should there be another? The first one has what is done once, and counts only
  /// where it is alone.
  bool step();
  /// One solve, or one look at energies.
  void solve(double seconds) { solve_ = seconds; }
  void look(double seconds) { look_ = seconds; }

  /// What a run in time would be: tells it, and ends the summary.
  /// @param steps left to do   @param length of one [s]
  void tell_time(int steps, double length);
  /// The same of a static run of so many loads.
  void tell_loads(int loads, int iterations);

private:
  struct Cost {
    std::string name;
    double count = 0.0, seconds = 0.0; ///< how often, and of one [s]
  };
  void tell(const std::vector<Cost>& costs, const std::string& bound);
  double pictures(int steps) const;
  double slowest(double seconds) const;

  RunFiles& files_;
  double picture_ = 0.0, bytes_ = 0.0, staying_ = 0.0; // seconds and bytes of one set of fields
  double solve_ = 0.0, look_ = 0.0;                    // [s]
  int steps_ = 0;                                      // timed so far
  double begin_ = 0.0, first_ = 0.0, last_ = 0.0;
};
} // namespace pdx::app
