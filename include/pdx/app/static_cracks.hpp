#pragma once
#include "pdx/app/crack_state.hpp"
#include "pdx/app/run_files.hpp"

#include <nlohmann/json_fwd.hpp>

namespace pdx::app {
/// The cracks of a static scene from load to load: columns of history.csv, results, and crack_path.csv. All is counted
/// from the cracks that were given, wherever patches are now. `look` is collective.
class StaticCracks {
public:
  explicit StaticCracks(const RunFiles& files); ///< the scene stands as it was given

  void add_columns(std::vector<io::Column>& columns) const;
  void add_row(std::vector<double>& row) const;

  /// Looks again, if bonds broke since the last look.
  void look(const Discretisation& d, double load);
  const CrackState& now() const { return now_; }
  void write_paths() const; ///< if bonds can break. Collective.

private:
  struct Mark {
    double load = 0.0, grown = 0.0; // how far a tip had come [-], [m]
  };
  double load_at(std::size_t end, double distance) const;

  const RunFiles& files_;
  CrackState now_;
  double given_length_ = 0.0;            // of the first tip's crack [m]
  std::int64_t broken_ = -1;             // at the last look
  std::vector<std::vector<Mark>> marks_; // of each end, rising in both
};
} // namespace pdx::app
