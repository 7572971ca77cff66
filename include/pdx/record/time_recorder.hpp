#pragma once
#include "pdx/record/crack_watch.hpp"
#include "pdx/record/section_watch.hpp"
#include "pdx/scene/scene.hpp"
#include "pdx/solve/time_driver.hpp"

namespace pdx::record {

/// Where the energy of a moving body is, on all ranks. [J]
struct MotionEnergies {
  double kinetic_elements = 0.0, kinetic_particles = 0.0, kinetic_points = 0.0; ///< the last of mixed scenes
  double scheme = 0.0; ///< dt^2/8 a.M a, see solve::KineticEnergy
  post::Energies stored;
  double work = 0.0, initial = 0.0;
  double converted = 0.0; ///< what changes of layout added; below 0: took

  double total() const { return kinetic() - scheme + stored.elastic() + stored.taken(); }
  double kinetic() const { return kinetic_elements + kinetic_particles + kinetic_points; }
  /// What came in and is nowhere: 0 to rounding in a linear scene.
  double residual() const
  {
    return initial + work + converted - kinetic() + scheme - stored.elastic() - stored.taken();
  }
};

/// What a run in time adds to its files. All methods are collective.
class TimeRecorder {
public:
  explicit TimeRecorder(RunFiles& files) : files_(files) {}
  void built(const scene::Standing& scene);
  void started(const solve::TimeDriver& driver, const scene::StepLimits& limits);
  void after_step(const solve::TimeDriver& driver);
  /// The scene is about to go: what is to be known of its cracks. Collective.
  /// @param for_another layout, where particles that broke here may be gone
  std::optional<scene::CrackNotes> leave_scene(const solve::TimeDriver& driver, bool for_another);
  /// Another stands in its place, and a driver has taken over its state: books the energy that came or went.
  void take_scene(const scene::Standing& scene, const solve::TimeDriver& driver,
                  std::optional<scene::CrackNotes> cracks);
  /// Steps have become shorter: a given length is kept no more, which is worth a warning. @param before their length
  /// [s]
  /// @param limit of stable steps now [s]
  void tell_shorter(const solve::TimeDriver& driver, double before, double limit);
  /// Running values that a restarted run needs, by name.
  using Notes = std::map<std::string, double>;
  Notes notes() const;
  void take_notes(const Notes& notes);
  CrackWatch* cracks() const { return cracks_.get(); } ///< null where no crack can grow from a given tip
  void finish(const solve::TimeDriver& driver);        ///< results of the end
  void interrupted(const solve::TimeDriver& driver);   ///< a signal came; no failure
  void stopped_at(const solve::TimeDriver& driver);    ///< the solver gave up: what the last sound state holds

  MotionEnergies energies(const solve::TimeDriver& driver) const; ///< as they are. Collective.

private:
  bool told(const solve::TimeDriver& driver) const;
  void count(const MotionEnergies& energies);
  void count_seconds(double output_begin);
  MotionEnergies look(const solve::TimeDriver& driver);
  void write_history(const solve::TimeDriver& driver, const MotionEnergies& energies);
  void write_results(const solve::TimeDriver& driver, const MotionEnergies& e);
  void write_tiles();
  void write_cells();
  void print_phases(const solve::TimeDriver& driver);
  bool fields_due(const solve::TimeDriver& driver);

  RunFiles& files_;
  const scene::Model* d_ = nullptr;
  scene::Tiles tiles_, cells_; // of scenes that are gone
  std::optional<SectionWatch> sections_;
  std::unique_ptr<CrackWatch> cracks_; // null where no crack can grow from a given tip
  scene::StepLimits limits_;
  pd::Broken broken_;                   // of all ranks, at the last look
  double largest_energy_ = 0.0;         // put in so far, at any look [J]
  double largest_residual_ = 0.0;       // [J]
  double converted_ = 0.0, left_ = 0.0; // energy by changes of layout; in the scene that was left [J]
  std::vector<double> bodies_start_;    // of the scene that was left: `scene::BodyLedger::start`
  double begin_ = 0.0, output_ = 0.0;
  int first_step_ = 0;
  int pictured_ = -1;         // step whose fields were written last
  std::size_t next_time_ = 0; // of OutputOptions::times
};
} // namespace pdx::record
