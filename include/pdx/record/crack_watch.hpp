#pragma once
#include "pdx/record/run_files.hpp"
#include "pdx/scene/crack_notes.hpp"
#include "pdx/track/crack_tracker.hpp"

namespace pdx::record {

/// The cracks of a scene in time, those of a solid as its middle layer shows them: columns of history.csv, results, and
/// crack_path.csv. All is counted from the cracks and the lattices that were given first, whatever of them the layout
/// holds now. All methods but `columns`, `row` and `knows` are collective.
class CrackWatch {
public:
  /// None where no bond can break or no crack has a tip in a patch.
  static std::unique_ptr<CrackWatch> make(const RunFiles& files);

  static void columns(std::vector<io::Column>& columns);
  void row(std::vector<double>& row) const;

  /// @param bonds_broken of all ranks: damage is looked at only where it changed
  void look(double time, std::int64_t bonds_broken);
  bool looked() const { return broken_ >= 0; }
  std::optional<scene::CrackNotes> notes() const; ///< none before the first look
  void take_notes(scene::CrackNotes notes);       ///< instead of the first look
  void note_new(); ///< particles that were not there before the layout changed begin from here
  /// Is all that damage has reached in the body, on a lattice of those that were given?
  bool knows(const scene::CrackNotes& notes) const;
  void write_results(nlohmann::ordered_json& results) const;
  void write_paths() const;

private:
  CrackWatch(const RunFiles& files, const scene::Part& part);

  const RunFiles& files_;
  const scene::Part& part_; // whose cracks are followed
  crack::CrackSet given_;   // first
  track::CrackTracker tracker_;
  double given_length_ = 0.0; // inside the body [m]
  std::int64_t broken_ = -1;  // at the last look; -1 before the first
};
} // namespace pdx::record
