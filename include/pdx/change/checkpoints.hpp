#pragma once
#include "pdx/base/stop_signals.hpp"
#include "pdx/change/patch_mover.hpp"
#include "pdx/record/scene_tables.hpp"
#include "pdx/record/time_recorder.hpp"
#include "pdx/scene/layout.hpp"

namespace pdx::change {
/// Writes `checkpoint.h5` when it is time or a signal says so, and goes on from one. All methods are collective.
class Checkpoints {
public:
  /// Reads the head of `-restart`, so that files can go on where it was written, and its layout, for the scene to be
  /// built by. Throws UserError for a file that is none.
  /// @param mover of its patches: goes on from the file; must outlive this
  Checkpoints(record::RunFiles& files, PatchMover& mover);
  const std::optional<scene::Layout>& restarted() const { return from_layout_; } ///< none from the start
  const scene::Dormant& dormant() const { return dormant_; }                     ///< under the layout of the moment
  /// The scene stands and nothing has moved: takes over the state of `-restart`, if there is one. Throws UserError if
  /// it is of another scene.
  void begin(const scene::Standing& scene, const scene::Layout& layout, solve::TimeDriver& driver,
             record::TimeRecorder& recorder);
  /// Another scene stands in its place, with the same state, which the driver keeps as sound.
  /// A change of layout made steps shorter [s].
  void step_is(double length) { step_length_ = length; }
  void take_scene(const scene::Standing& scene, const scene::Layout& layout, const scene::Dormant& dormant,
                  const record::TimeRecorder& recorder);
  solve::TimeDriver::Verdict after_step(const solve::TimeDriver& driver, const record::TimeRecorder& recorder);
  /// The end, or the last sound state of a run gone wild: a checkpoint too, if any were asked for.
  void finish(const solve::TimeDriver& driver, const record::TimeRecorder& recorder);
  void failed(const solve::TimeDriver& driver);

  const std::string& stopped() const { return stopped_; } ///< why and where a signal ended the run; empty: none did

private:
  using Numbers = std::map<std::string, double>;
  bool asked() const { return options_.interval > 0 || options_.seconds > 0.0; }
  /// What recorders know, at one step.
  struct Kept {
    Numbers numbers;
    std::optional<scene::CrackNotes> cracks;
  };
  Kept kept_now(const record::TimeRecorder& recorder) const;
  void look_around(const solve::TimeDriver& driver);
  void read_head();
  void stand_on(const scene::Standing& scene, const scene::Layout& layout);
  record::SceneTables& tables();
  void read_sums(solve::TimeDriver::Clock& clock) const;
  void write(const solve::TimeDriver& driver, Kept kept);
  void write_sums(io::Hdf5File& file, const solve::TimeDriver& driver) const;
  couple::BondBreaker* breaker() const { return scene_.model->breaker; }

  record::RunFiles& files_;
  PatchMover& mover_;
  const options::CheckpointOptions& options_;
  std::string given_; // the scene as the options say it
  StopSignals signals_;
  std::unique_ptr<io::SealedReader> from_;   // until the state is taken over
  std::optional<scene::Layout> from_layout_; // its
  scene::Standing scene_;
  scene::Layout layout_;
  scene::Dormant dormant_;
  std::unique_ptr<record::SceneTables> tables_; // of scene_, once they were asked for
  Numbers head_;                                // of -restart
  Kept sound_;                                  // where the driver can go back to
  std::string stopped_;
  double step_length_ = 0.0; // of the steps, but for the last ones before the end [s]
  double step_given_ = 0.0;  // that the run began with, before changes of layout made it shorter [s]
  int next_look_ = 0, looked_step_ = 0;
  double looked_ = 0.0, written_ = 0.0; // wall clock [s]
  struct {
    int signal = 0, write = 0;
  } due_;
};
} // namespace pdx::change
