#pragma once
#include "pdx/record/crack_state.hpp"
#include "pdx/record/new_cracks.hpp"
#include "pdx/record/run_files.hpp"
#include "pdx/record/tip_j.hpp"

#include <nlohmann/json_fwd.hpp>

namespace pdx::record {
/// The cracks of a static scene from load to load: columns of history.csv, results, and crack_path.csv. All is counted
/// from the cracks that were given, wherever patches are now. `look` is collective.
class StaticCracks {
public:
  /// How far a tip had come at a load.
  struct Mark {
    std::size_t end = 0;
    double load = 0.0, grown = 0.0; ///< [-], [m]
  };

  explicit StaticCracks(const RunFiles& files); ///< a scene stands

  void add_columns(std::vector<io::Column>& columns) const;
  void add_row(std::vector<double>& row) const;
  /// K_I, K_II and T of each tip, not a number where there are none.
  ///@{
  void add_mode_columns(std::vector<io::Column>& columns) const;
  static void add_modes(std::span<const std::optional<post::TipModes>> modes, std::vector<double>& row);
  ///@}

  /// Looks again, if bonds broke since the last look.
  void look(const scene::Discretisation& d, double load);
  const CrackState& now() const { return now_; }
  void write_paths() const; ///< if bonds can break. Collective.
  /// Of cracks that began by themselves, where heat strains the body.
  void add_results(nlohmann::ordered_json& results) const;

  std::vector<Mark> marks() const; ///< of all tips, tip by tip
  /// Goes on from those of another run of the same cracks. False if they are of others.
  bool take_marks(std::span<const Mark> marks);

private:
  double load_at(std::size_t end, double distance) const;

  const RunFiles& files_;
  CrackState now_;
  std::optional<NewCracks> new_;
  double given_length_ = 0.0;            // of the first tip's crack [m]
  std::int64_t broken_ = -1;             // at the last look
  std::vector<std::vector<Mark>> marks_; // of each end, rising in both
};
} // namespace pdx::record
