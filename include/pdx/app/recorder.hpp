#pragma once
#include "pdx/app/discretisation.hpp"
#include "pdx/io/curve.hpp"
#include "pdx/io/progress.hpp"
#include "pdx/io/snapshot.hpp"
#include "pdx/io/summary.hpp"
#include "pdx/post/energy_ledger.hpp"
#include "pdx/post/error_norm.hpp"
#include "pdx/solve/static_driver.hpp"

namespace pdx::app {
/// Solved before the scene itself, where asked for.
struct Prior {
  std::vector<double> reference;      ///< elements-only displacement per local vertex [m]
  std::vector<double> energy_release; ///< -dPi/da of each tip [J/m^2]
};

/// Writes what a run leaves behind: fields and history as asked, `summary.json` always, progress and the closing table.
/// All methods are collective.
class Recorder {
public:
  Recorder(MPI_Comm comm, const SceneOptions& options, double begin);
  /// The scene stands: opens the files asked for.
  void built(mesh::Mesh& mesh, const PatchPlan& plan, const Discretisation& d);
  void started(); ///< set-up is over, solving begins
  void accept(const solve::Step& step, Vec u, const solve::StaticDriver& driver, const Prior& prior);
  void count(const solve::StaticReport& report); ///< what it cost so far, for the summary
  void finish(const solve::StaticReport& report);
  void stopped_at(Vec u); ///< the solver gave up: results and fields of the last accepted step
  void fail(const std::string& why);
  void warn(const std::string& what); ///< a line on standard error, even when quiet

private:
  /// Force on each held part, and the largest of each component so far with its load.
  struct Reactions {
    std::vector<double> now, peak, peak_load; ///< x and y of part after part [N], [-]
  };
  void open_history();
  void report_cracks();
  void take_stock(const solve::Step& step, Vec u, const solve::StaticDriver& driver);
  void write_history(const solve::Step& step);
  void write_fields(const solve::Step& step, Vec u, const post::DisplacementError* error);
  void write_results(Vec u, const Prior& prior, const post::DisplacementError* error);
  bool grows() const { return d_->fracture != nullptr; }
  void write_summary(const char* status);
  void print_phases(const solve::StaticReport& report);

  MPI_Comm comm_;
  const SceneOptions& options_;
  double begin_;
  io::Progress progress_;
  io::Summary summary_;
  mesh::Mesh* mesh_ = nullptr;
  const PatchPlan* plan_ = nullptr;
  const Discretisation* d_ = nullptr;
  std::unique_ptr<io::FieldsFile> fields_;
  std::unique_ptr<io::Curve> history_;
  std::unique_ptr<post::EnergyLedger> ledger_;
  Reactions reactions_;
  std::optional<solve::Step> fields_due_; // the last accepted step, if its fields were left out
};
} // namespace pdx::app
