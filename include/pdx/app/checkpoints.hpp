#pragma once
#include "pdx/app/layout.hpp"
#include "pdx/app/patch_mover.hpp"
#include "pdx/app/scene_tables.hpp"
#include "pdx/app/time_recorder.hpp"
#include "pdx/base/stop_signals.hpp"

namespace pdx::app {
/// Writes `checkpoint.h5` when it is time or a signal says so, and goes on from one. All methods are collective.
class Checkpoints {
public:
  /// Reads the head of `-restart`, so that files can go on where it was written, and its layout, for the scene to be
  /// built by. Throws UserError for a file that is none.
  /// @param mover of its patches: goes on from the file; must outlive this
  Checkpoints(RunFiles& files, PatchMover& mover);
  const std::optional<Layout>& restarted() const { return from_layout_; } ///< none from the start
  const Dormant& dormant() const { return dormant_; }                     ///< under the layout of the moment
  /// The scene stands and nothing has moved: takes over the state of `-restart`, if there is one. Throws UserError if
  /// it is of another scene.
  void begin(const Standing& scene, const Layout& layout, solve::TimeDriver& driver, TimeRecorder& recorder);
  /// Another scene stands in its place, with the same state, which the driver keeps as sound.
  /// A change of layout made steps shorter [s].
  void step_is(double length) { step_length_ = length; }
  void take_scene(const Standing& scene, const Layout& layout, const Dormant& dormant, const TimeRecorder& recorder);
  solve::TimeDriver::Verdict after_step(const solve::TimeDriver& driver, const TimeRecorder& recorder);
  /// The end, or the last sound state of a run gone wild: a checkpoint too, if any were asked for.
  void finish(const solve::TimeDriver& driver, const TimeRecorder& recorder);
  void failed(const solve::TimeDriver& driver);

  const std::string& stopped() const { return stopped_; } ///< why and where a signal ended the run; empty: none did

private:
  using Numbers = std::map<std::string, double>;
  bool asked() const { return options_.interval > 0 || options_.seconds > 0.0; }
  /// What recorders know, at one step.
  struct Kept {
    Numbers numbers;
    std::optional<CrackNotes> cracks;
  };
  Kept kept_now(const TimeRecorder& recorder) const;
  void look_around(const solve::TimeDriver& driver);
  void read_head();
  void stand_on(const Standing& scene, const Layout& layout);
  SceneTables& tables();
  void read_sums(solve::TimeDriver::Clock& clock) const;
  void write(const solve::TimeDriver& driver, Kept kept);
  void write_sums(io::Hdf5File& file, const solve::TimeDriver& driver) const;
  couple::BondBreaker* breaker() const { return scene_.model->breaker; }

  RunFiles& files_;
  PatchMover& mover_;
  const CheckpointOptions& options_;
  std::string given_; // the scene as the options say it
  StopSignals signals_;
  std::unique_ptr<io::SealedReader> from_; // until the state is taken over
  std::optional<Layout> from_layout_;      // its
  Standing scene_;
  Layout layout_;
  Dormant dormant_;
  std::unique_ptr<SceneTables> tables_; // of scene_, once they were asked for
  Numbers head_;                        // of -restart
  Kept sound_;                          // where the driver can go back to
  std::string stopped_;
  double step_length_ = 0.0; // of the steps, but for the last ones before the end [s]
  double step_given_ = 0.0;  // that the run began with, before changes of layout made it shorter [s]
  int next_look_ = 0, looked_step_ = 0;
  double looked_ = 0.0, written_ = 0.0; // wall clock [s]
  struct {
    int signal = 0, write = 0;
  } due_;
};
} // namespace pdx::app
