#pragma once
#include "pdx/app/run_files.hpp"
#include "pdx/post/crack_tracker.hpp"

namespace pdx::app {
/// The cracks of a scene in time, those of a solid as its middle layer shows them: columns of history.csv, results, and
/// crack_path.csv. All methods but `columns` and `row` are collective.
class CrackWatch {
public:
  /// None where no bond can break or no crack has a tip in a patch.
  static std::unique_ptr<CrackWatch> make(const RunFiles& files);

  static void columns(std::vector<io::Column>& columns);
  void row(std::vector<double>& row) const;

  /// @param bonds_broken of all ranks: damage is looked at only where it changed
  void look(double time, std::int64_t bonds_broken);
  post::CrackTracker& tracker() { return tracker_; } ///< for checkpoints
  void write_results(nlohmann::ordered_json& results) const;
  void write_paths() const;

private:
  explicit CrackWatch(const RunFiles& files);
  void look_at_layer(double time);

  const RunFiles& files_;
  post::CrackTracker tracker_;
  double given_ = 0.0; ///< length of the cracks at the start [m]
  std::int64_t broken_ = -1;
};
} // namespace pdx::app
