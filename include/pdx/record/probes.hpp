#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/field/output_field.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/io/curve.hpp"
#include "pdx/options/probe_options.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace pdx::record {

/// How a value at a place follows from those of points: in an element bilinear in its corners, between particles on
/// the corners of a square bilinear in these, else that of the nearest particle.
struct ProbeHost {
  std::string block;
  bool cells = false; ///< `points` are numbers of the file's points, else natural ones
  std::vector<std::int64_t> points;
  std::vector<double> weights;
  double distance = 0.0; ///< from the nearest of them; 0 in an element [m]
};

/// What holds a place, the same on every rank; none: nothing does. Collective.
/// @param place in the frame that blocks are in [m]   @param spacing of particles, 0: there are several [m]
std::optional<ProbeHost> probe_host(MPI_Comm comm, std::span<const field::OutputBlock> blocks, const Vector<3>& place,
                                    double spacing);
/// Values of a field there, one for each component, empty where the host's block has no such field; the same on every
/// rank. Collective.
std::vector<double> probe_value(MPI_Comm comm, std::span<const field::OutputBlock> blocks, const ProbeHost& host,
                                const std::string& field);

/// What probes ask of the scene that stands.
struct Probed {
  MPI_Comm comm;
  geom::Frame frame;
  int dim;        ///< components of vectors
  double spacing; ///< of particles on a lattice, 0: there are several, or none [m]
  double reach;   ///< a place farther from all particles is outside [m]
  /// Blocks of fields as they are now; with `velocity` what they call displacement is velocity. Collective.
  std::function<std::vector<field::OutputBlock>(bool velocity)> blocks;
};

/// The probes of a run and their files `probe_NAME.csv`. All methods are collective.
class Probes {
public:
  /// @param time of a row: name and unit
  Probes(std::vector<options::ProbeOptions> options, std::filesystem::path directory, io::Column time)
      : options_(std::move(options)), directory_(std::move(directory)), time_(std::move(time)), states_(options_.size())
  {}
  /// Files begin, with a row for this step. Throws UserError for a place that nothing holds and a field that is not
  /// there.
  /// @param keep_to goes on with files behind their rows up to this step
  void begin(const Probed& scene, int step, double time, std::optional<double> keep_to);
  /// Rows of the probes that are due at this step, or of all; once for a step.
  void look(const Probed& scene, int step, double time, bool all = false);
  bool due(int step, bool all) const;
  /// Points and particles have other owners or numbers: places are looked up anew.
  void forget_hosts();
  void close();

private:
  struct State {
    std::unique_ptr<io::Curve> file;
    std::vector<std::optional<ProbeHost>> hosts; ///< by place; empty: to be looked up
    std::vector<std::size_t> components;         ///< of each field
    int written = -1;                            ///< step
  };
  struct Pictures {
    std::vector<field::OutputBlock> still, moving; ///< moving: only where velocity is asked for
  };
  Pictures pictures(const Probed& scene) const;
  void find(const Probed& scene, const options::ProbeOptions& probe, State& state, const Pictures& now) const;
  std::vector<double> value(const Probed& scene, const ProbeHost& host, const std::string& field,
                            const Pictures& now) const;
  void open(const Probed& scene, const options::ProbeOptions& probe, State& state, const Pictures& now,
            std::optional<double> keep_to);
  void write(const Probed& scene, const options::ProbeOptions& probe, State& state, const Pictures& now, double time);

  std::vector<options::ProbeOptions> options_;
  std::filesystem::path directory_;
  io::Column time_;
  std::vector<State> states_;
};
} // namespace pdx::record
