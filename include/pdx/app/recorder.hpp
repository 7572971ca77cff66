#pragma once
#include "pdx/app/discretisation.hpp"
#include "pdx/io/curve.hpp"
#include "pdx/io/progress.hpp"
#include "pdx/io/snapshot.hpp"
#include "pdx/io/summary.hpp"
#include "pdx/post/error_norm.hpp"
#include "pdx/solve/static_driver.hpp"

namespace pdx::app {
/// Writes what a run leaves behind: fields and history as asked, `summary.json` always, progress and the closing table.
/// All methods are collective.
class Recorder {
public:
  Recorder(MPI_Comm comm, const SceneOptions& options, double begin);
  /// The scene stands: opens the files asked for.
  void built(const mesh::Mesh& mesh, const PatchPlan& plan, const Discretisation& d);
  void started(); ///< set-up is over, solving begins
  /// @param reference elements-only displacement per local vertex, empty without
  void accept(int step, Vec u, const solve::StaticDriver& driver, const std::vector<double>& reference);
  void count(const solve::StaticReport& report); ///< what it cost so far, for the summary
  void finish(const solve::StaticReport& report);
  void fail(const std::string& why);
  void warn(const std::string& what); ///< a line on standard error, even when quiet

private:
  void open_history();
  void write_history(int step, Vec u, const solve::StaticDriver& driver);
  void write_results(Vec u, const solve::StaticDriver& driver, const post::DisplacementError* error);
  std::vector<double> reactions(Vec u, const solve::StaticDriver& driver, double load) const;
  std::vector<double> energies(Vec u) const;
  void write_summary(const char* status);
  void print_phases(const solve::StaticReport& report);

  MPI_Comm comm_;
  const SceneOptions& options_;
  double begin_;
  io::Progress progress_;
  io::Summary summary_;
  const mesh::Mesh* mesh_ = nullptr;
  const PatchPlan* plan_ = nullptr;
  const Discretisation* d_ = nullptr;
  std::unique_ptr<io::FieldsFile> fields_;
  std::unique_ptr<io::Curve> history_;
};
} // namespace pdx::app
