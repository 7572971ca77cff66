#pragma once
#include "pdx/io/curve.hpp"
#include "pdx/io/progress.hpp"
#include "pdx/io/run_lock.hpp"
#include "pdx/io/snapshot.hpp"
#include "pdx/io/summary.hpp"
#include "pdx/post/energy_ledger.hpp"
#include "pdx/record/probes.hpp"
#include "pdx/scene/standing.hpp"

#include <functional>

namespace pdx::record {

/// A run that goes on from a checkpoint. If its files lie here, they go on too.
struct Continued {
  bool here = false;
  int step = 0, fields = 0; ///< steps done, and of them written to fields.h5
};

/// What every run leaves behind, static or in time: the directory, fields as asked, `summary.json` always, progress and
/// the closing table. All methods are collective.
class RunFiles {
public:
  RunFiles(MPI_Comm comm, const options::SceneOptions& options, double begin);
  /// The scene stands: counts it, reports its cracks.
  void built(const scene::Standing& scene);
  /// Another scene stands in its place.
  void take_scene(const scene::Standing& scene);
  void expect_history(std::vector<io::Column> columns) { columns_ = std::move(columns); }
  /// Set-up is over and nothing was refused: files of an earlier run go, those of this one are opened.
  void started();
  void write_fields(double time, Vec u, const std::vector<double>& relative_percent = {});
  /// Probes begin with a row, behind `started`, and have one where they are due, or all of them.
  ///@{
  void begin_probes(int step, double time, Vec u);
  void look_at_probes(int step, double time, Vec u, bool all = false);
  bool probes_due(int step) const { return probes_.due(step, false); } ///< u is asked for only then: rows may be behind
  ///@}
  void write_summary(const char* status);
  void fail(const std::string& why);
  /// Does what may throw UserError in the middle of a run: the summary says why it ended.
  void told_if_refused(const std::function<void()>& act);
  /// The machine failed this rank, and perhaps the others: says so, and leaves a summary where it can. Not collective.
  void lost(const std::string& why) noexcept;
  /// Writes what a run that failed still has. Where that fails too it is a warning: the first cause counts.
  void after_failure(const std::function<void()>& write) const;
  void stop(const std::string& why); ///< a signal came: no failure, and worth a line in any log
  /// A line on standard error, even when quiet; none for "". With -warnings_are_errors it ends the run: throws
  /// UserError. Collective, with the same text on every rank.
  void warn(const std::string& what);
  void warn_of_energy(); ///< where more is nowhere than was put in: such results are none
  /// Lines for `warn` when the scene stands: of what is refused before, its error alone is said.
  void warn_later(std::vector<std::string> lines) { waiting_ = std::move(lines); }
  /// Columns of the reactions of held parts, one for each direction.
  void add_reaction_columns(std::vector<io::Column>& columns) const;
  /// Where patches move: particles, elements, changes so far, and the energy that they brought [J].
  void add_layout_columns(std::vector<io::Column>& columns) const;
  void add_layout_row(std::vector<double>& row, double converted) const;
  void add_layout_results(double converted, double work);
  /// Conditions that hold or push, and those that turn.
  ///@{
  std::vector<std::string> held_names() const;
  std::vector<std::string> turned_names() const;
  ///@}
  /// Per `held_names` and direction the force on the body [N]; then per `turned_names` its moment about the centre,
  /// counter-clockwise [N m]. Collective.
  /// @param force of owned components, those of sets left out   @param local displacement [owned | halo] [m]
  std::vector<double> reactions(std::span<const double> force, std::span<const double> local) const;

  bool grows() const { return scene.model->fracture != nullptr; }
  MPI_Comm comm() const { return comm_; }
  const options::SceneOptions& options;
  scene::Standing scene;
  Continued continued;              ///< to be set before `started`
  double solved_before = 0.0;       ///< seconds of solves beside the scene's own: reference, energy release [s]
  double layout_seconds = 0.0;      ///< that changes of layout took [s]
  std::span<const double> velocity; ///< of owned components, in time; for fields [m/s]
  io::Progress progress;
  io::Summary summary;
  std::unique_ptr<io::FieldsFile> fields; ///< null: not asked for
  std::unique_ptr<io::Curve> history;     ///< null: not asked for

private:
  void report_cracks();
  void say_warning(const std::string& what) const;
  void make_room();
  std::filesystem::path summary_path() const;
  std::vector<field::OutputBlock> blocks(Vec u, const std::vector<double>& relative_percent);
  Probed probed(Vec u);

  MPI_Comm comm_;
  double begin_;
  std::unique_ptr<io::RunLock> lock_; // of the directory
  Probes probes_;
  std::vector<std::string> waiting_; // warnings
  std::vector<io::Column> columns_;  // of history.csv; none: not asked for
  bool room_made_ = false;
  std::int64_t elements_ = 0; // of all ranks
};
} // namespace pdx::record
