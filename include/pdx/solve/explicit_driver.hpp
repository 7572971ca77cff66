#pragma once
#include "pdx/field/system.hpp"
#include "pdx/solve/central_difference.hpp"

#include <functional>

namespace pdx::solve {
/// Length and end of the steps, besides PETSc's own `-ts_...`.
struct ExplicitOptions {
  double limit = 0.0;          ///< rigorous stable step of the scene [s]
  double safety = 0.9;         ///< share of it that a step takes by itself [-]
  bool allow_unstable = false; ///< let a given -ts_dt be above the limit
};

/// Sums over all ranks. [J]
struct KineticEnergy {
  double moving = 0.0; ///< 1/2 v.M v
  /// dt^2/8 a.M a of what is free. In a linear scene it is moving + strain energy - this that balances the work to the
  /// last digits: the oscillation of the scheme, not of the body.
  double scheme = 0.0;
};

/// Explicit dynamics of a System through TS. Rows move by their lumped mass; what is held follows its drives.
class ExplicitDriver {
public:
  /// The system, bound and with drives, must outlive the driver. Throws UserError for a step above the limit, an end
  /// that is not given, or an explicit TS type that is not ours. Collective.
  ExplicitDriver(field::System& system, const ExplicitOptions& options);

  enum class Verdict { go_on, stop };
  /// Called after each step, on every rank; everything below may be asked.
  using AfterEach = std::function<Verdict()>;
  /// Steps to the end, or until `after_each` says stop. Throws SolverFailure when energy grows beyond the work done; u,
  /// v and the rest are then those of the last state that was found sound (`good_step`). Collective.
  void run(const AfterEach& after_each);

  double time() const;
  int step() const;           ///< steps done
  double step_length() const; ///< [s]
  int expected_steps() const; ///< in all, if nothing stops the run

  std::span<const double> local() const { return u_; } ///< displacement, [owned | halo], as forces saw it last [m]
  std::span<const double> u() const { return {u_.data(), owned_}; }
  std::span<const double> v() const { return v_; }       ///< owned [m/s]
  std::span<const double> acceleration() const;          ///< owned [m/s^2]
  std::span<const double> mass() const { return mass_; } ///< owned rows [kg]
  std::span<const double> held_force() const
  {
    return held_;
  } ///< internal force of `held_components`, in that order [N]
  std::span<const Index> held_components() const { return system_.prescribed.components; }
  Vec displacement() const { return displacement_.get(); }
  /// Work of loads and prescribed motion since the start, this rank's part [J].
  double work() const { return work_; }
  KineticEnergy kinetic_energy() const; ///< Collective.

  /// All that a run needs besides u, v and the acceleration to go on to the last bit.
  struct Clock {
    double time = 0.0;
    int step = 0;
    double length = 0.0; ///< of the step to come [s]
    StepOrigin origin;
    double work = 0.0;         ///< of this rank [J]
    double energy_bound = 0.0; ///< what the kinetic energy is judged by [J]
    double initial = 0.0;      ///< energy at time 0 [J]
  };
  Clock clock() const;
  /// Goes on from a state: owned blocks, and the clock. Collective.
  void resume(const Clock& clock, std::span<const double> u, std::span<const double> v, std::span<const double> a);

private:
  struct Load {
    const field::Drive* drive;
    std::vector<double> before; // displacement of its components before the step [m]
  };
  void choose_step(const ExplicitOptions& options);
  void accelerate(double time, double* a);
  void untie(double* f) const;
  void tie(double* a) const;
  void move(double time, double* u) const;
  void move_velocity(double time, double* v) const;
  void note_before();
  void book_work();
  double held_kinetic() const;
  void after_step();
  bool sound();
  std::string describe_wildness() const;
  void set_state(const Clock& clock, std::span<const double> a);
  void keep();
  void go_back();

  field::System& system_;
  std::size_t owned_;
  std::vector<double> u_, v_, mass_, inverse_mass_; // u_ [owned | halo]
  std::vector<field::Tie> ties_;
  VecHandle displacement_, velocity_;
  TsHandle ts_;
  std::vector<Load> loads_;
  std::vector<double> load_; // of loads_, concatenated, at the last evaluation [N]
  std::vector<double> load_before_;
  std::vector<double> held_, held_before_, held_u_before_;
  double held_kinetic_before_ = 0.0, work_ = 0.0, energy_bound_ = 0.0;
  AfterEach after_each_;
  bool resumed_ = false;
  struct Good {
    std::vector<double> u, v, a;
    Clock clock;
  } good_;
};
} // namespace pdx::solve
