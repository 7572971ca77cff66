#pragma once
#include "pdx/app/scene_state.hpp"
#include "pdx/app/time_recorder.hpp"
#include "pdx/base/stop_signals.hpp"

namespace pdx::app {
/// Writes `checkpoint.h5` when it is time or a signal says so, and goes on from one. All methods are collective.
class Checkpoints {
public:
  /// Reads the head of `-restart`, so that files can go on where it was written. Throws UserError for a file that is
  /// none.
  explicit Checkpoints(RunFiles& files);
  /// The scene stands and nothing has moved: takes over the state of `-restart`, if there is one. Throws UserError if
  /// it is of another scene.
  void begin(const Standing& scene, solve::TimeDriver& driver, TimeRecorder& recorder);
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
  void refuse_other_scene() const;
  void read_sums(solve::TimeDriver::Clock& clock) const;
  void write(const solve::TimeDriver& driver, Kept kept);
  void write_sums(io::Hdf5File& file, const solve::TimeDriver& driver) const;

  RunFiles& files_;
  const CheckpointOptions& options_;
  StopSignals signals_;
  std::unique_ptr<io::SealedReader> from_; // until the state is taken over
  std::unique_ptr<SceneState> scene_;
  couple::BondBreaker* breaker_ = nullptr;
  Numbers head_; // of -restart
  Kept sound_;   // where the driver can go back to
  std::string stopped_;
  double step_length_ = 0.0; // that the run began with [s]
  int next_look_ = 0, looked_step_ = 0;
  double looked_ = 0.0, written_ = 0.0; // wall clock [s]
  struct {
    int signal = 0, write = 0;
  } due_;
};
} // namespace pdx::app
