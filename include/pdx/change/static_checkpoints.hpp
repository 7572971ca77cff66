#pragma once
#include "pdx/change/patch_mover.hpp"
#include "pdx/record/recorder.hpp"
#include "pdx/record/scene_tables.hpp"
#include "pdx/scene/layout.hpp"

namespace pdx::change {
/// A static run between two loads. All that is referred to must outlive it.
struct BetweenLoads {
  const scene::Standing& scene;
  const scene::Layout& layout;
  const scene::Dormant& dormant;
  const solve::LoadPath& path;
  const solve::StaticReport& report;
  const record::Recorder& recorder;
  Vec u;       ///< accepted last
  double load; ///< likewise [-]
};

/// `checkpoint.h5` of static runs: what was accepted, and where on its path of loads that is. All methods are
/// collective.
class StaticCheckpoints {
public:
  /// Reads the head of `-restart`, so that files can go on where it was written, and its layout, for the scene to be
  /// built by. Throws UserError for a file that is none, or of another scene.
  /// @param mover of its patches: goes on from the file; must outlive this
  StaticCheckpoints(record::RunFiles& files, PatchMover& mover);
  bool goes_on() const { return layout_.has_value(); }       ///< from a file
  const scene::Layout& layout() const { return *layout_; }   ///< its, if it goes on
  const scene::Dormant& dormant() const { return dormant_; } ///< under its layout

  /// What a run goes on with.
  struct Start {
    std::vector<double> u; ///< owned components of the scene [m]
    solve::StaticReport report;
    double load = 0.0; ///< accepted last [-]
    record::RecorderNotes notes;
  };
  /// The scene stands as the file's layout says: bonds break that are broken there, and the path goes on from where it
  /// was. Throws UserError for a state of another scene, and for a place within parts that this path does not have.
  Start start(const scene::Standing& scene, solve::LoadPath& path);

  /// Is one to be written behind this load?
  bool due(int step, bool last) const;
  void write(const BetweenLoads& now);
  bool asked() const { return options_.interval > 0 || options_.seconds > 0.0; }
  std::string file() const; ///< that `write` writes

private:
  record::RunFiles& files_;
  PatchMover& mover_;
  const options::CheckpointOptions& options_;
  std::string given_;                      // the scene as the options say it
  std::unique_ptr<io::SealedReader> from_; // until the state is taken over
  record::NamedNumbers head_;              // of -restart
  std::optional<scene::Layout> layout_;    // likewise
  scene::Dormant dormant_;
  double written_; // wall clock [s]
};
} // namespace pdx::change
