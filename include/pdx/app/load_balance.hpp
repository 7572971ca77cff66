#pragma once
#include "pdx/app/run_files.hpp"
#include "pdx/solve/time_driver.hpp"

namespace pdx::app {
/// Looks from time to time how evenly the ranks work, and says when and how the cells are to be dealt out anew: by the
/// time their elements and particles took. All methods are collective.
class LoadBalance {
public:
  /// @param threshold the busiest rank's time over the mean, above which cells are dealt out anew; 0: never
  LoadBalance(MPI_Comm comm, double threshold) : comm_(comm), threshold_(threshold) {}

  /// After each step; does nothing but every 50th, after each change twice as rarely.
  bool due(const solve::TimeDriver& driver);
  /// Time of each cell of the mesh since the last look, in ns a step, on rank 0.
  mesh::MeasuredCosts costs(const Standing& scene, const solve::TimeDriver& driver) const;
  /// A driver begins on another scene: measures from here on.
  void begin(const solve::TimeDriver& driver);
  /// The same, after cells were dealt out anew.
  void changed(const solve::TimeDriver& driver);

  int changes() const { return changes_; }
  double imbalance() const { return imbalance_; } ///< busiest rank over the mean, at the last look; 0: none yet

private:
  MPI_Comm comm_;
  double threshold_;
  int since_ = 0, steps_ = 1; // step of the last look, and how many lie behind it
  int interval_ = 50, changes_ = 0;
  std::vector<double> before_, now_; // busy time of each Term at the last two looks [s]
  double imbalance_ = 0.0;
};
} // namespace pdx::app
