#pragma once
#include "pdx/post/error_norm.hpp"
#include "pdx/record/checkpoint_file.hpp"
#include "pdx/record/prior.hpp"
#include "pdx/record/static_cracks.hpp"
#include "pdx/scene/named_state.hpp"
#include "pdx/solve/static_driver.hpp"

namespace pdx::record {
/// Running values that a restarted run needs.
struct RecorderNotes {
  NamedNumbers numbers;
  std::vector<StaticCracks::Mark> marks;
};

/// What a static run adds to its files: energies, reactions, cracks and J of accepted loads. All methods are
/// collective.
class Recorder {
public:
  explicit Recorder(RunFiles& files) : files_(files), options_(files.options) {}
  /// @param d on the mesh; outlives this, or until the next takes its place
  void built(mesh::Mesh& mesh, const scene::Discretisation& d);
  /// What is booked by row goes on in another scene.
  /// @param u, internal_force of its owned components at the load accepted last [m, N]
  void take_scene(mesh::Mesh& mesh, const scene::Discretisation& d, double load, std::vector<double> u,
                  std::span<const double> internal_force);
  void book_change(double energy) { converted_ += energy; } ///< that a change of layout brought, of all ranks [J]
  void accept(const solve::Step& step, Vec u, const solve::StaticDriver& driver, const Prior& prior);
  /// A load is being worked at that bonds break at, or that was given up and will be approached by half: says so, now
  /// and then. @param load aimed at [-]
  void working(const solve::StaticReport& report, double load);
  void count(const solve::StaticReport& report); ///< what it cost so far, for the summary
  void finish(const solve::StaticReport& report);
  void stopped_at(Vec u); ///< the solver gave up: results and fields of the last accepted step

  RecorderNotes notes() const;
  /// What is wrong with the numbers among notes, "" if nothing is.
  static std::string fault_of(const NamedNumbers& numbers);
  /// Goes on from the notes of another run, whose state the scene has taken over. Throws UserError for notes that do
  /// not fit it.
  void take_notes(const RecorderNotes& notes, double load, std::vector<double> u,
                  std::span<const double> internal_force);

private:
  /// Force on each held part, and the largest of each component so far with its load.
  struct Reactions {
    std::vector<double> now, peak, peak_load; ///< x and y of part after part [N], [-]
  };
  std::string said_so_far(const solve::StaticReport& report) const;
  void open_history();
  void take_stock(const solve::Step& step, Vec u, const solve::StaticDriver& driver);
  void write_history(const solve::Step& step, Vec u);
  void write_fields(const solve::Step& step, Vec u, const post::DisplacementError* error);
  void write_results(Vec u, const Prior& prior, const post::DisplacementError* error);
  void print_phases(const solve::StaticReport& report);

  RunFiles& files_;
  const options::SceneOptions& options_;
  const scene::Discretisation* d_ = nullptr;
  std::unique_ptr<post::EnergyLedger> ledger_;
  std::unique_ptr<StaticCracks> cracks_;
  double converted_ = 0.0; // [J]
  double load_ = 0.0;      // accepted last
  Reactions reactions_;
  std::optional<solve::Step> fields_due_; // the last accepted step, if its fields were left out
};
} // namespace pdx::record
