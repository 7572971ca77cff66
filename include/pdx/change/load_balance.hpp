#pragma once
#include "pdx/record/run_files.hpp"
#include "pdx/solve/time_driver.hpp"

namespace pdx::change {
/// Looks from time to time how evenly the ranks work, and says when and how the cells are to be dealt out anew: by the
/// time their elements and particles took. All methods but `leave` are collective.
class LoadBalance {
public:
  /// @param threshold the busiest rank's time over the mean, above which cells are dealt out anew; 0: never
  LoadBalance(MPI_Comm comm, double threshold) : comm_(comm), threshold_(threshold), limit_(threshold) {}

  /// After each step; looks at every 50th, after each change twice as rarely. True if two looks in a row were above the
  /// threshold: one may have met another program on the machine.
  bool due(const solve::TimeDriver& driver);
  /// Time of each cell of the mesh between the last two looks, in ns a step, on rank 0.
  mesh::MeasuredCosts costs(const scene::Standing& scene, const solve::TimeDriver& driver) const;
  /// The driver is about to go: what it measured stays.
  void leave(const solve::TimeDriver& driver);
  /// The cells were dealt out anew. @param forecast the busiest rank over the mean by `costs`: where cells are too few
  /// to do better, it is not tried again for that
  void changed(const solve::TimeDriver& driver, double forecast);

  int changes() const { return changes_; }
  double imbalance() const { return imbalance_; } ///< busiest rank over the mean, at the last look; 0: none yet

private:
  std::vector<double> busy(const solve::TimeDriver& driver) const;

  MPI_Comm comm_;
  double threshold_, limit_;      // as asked for; above which something can be gained
  int since_ = 0, steps_ = 1;     // step of the last look, and how many lie behind it
  int interval_ = 50, above_ = 0; // steps between looks; looks in a row above the limit
  int changes_ = 0;
  std::vector<double> gone_;         // busy time of each Term under drivers that are gone [s]
  std::vector<double> before_, now_; // in all, at the last two looks [s]
  double imbalance_ = 0.0;
};
} // namespace pdx::change
