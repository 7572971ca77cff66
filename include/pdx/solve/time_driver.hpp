#pragma once
#include "pdx/field/state.hpp"
#include "pdx/solve/central_difference.hpp"
#include "pdx/solve/moving_system.hpp"
#include "pdx/solve/verdict.hpp"

namespace pdx::solve {
/// What steps a System through time by a TS, explicit or implicit, and what may be asked of it between two steps.
class TimeDriver {
public:
  using Verdict = solve::Verdict;
  /// Called after each step, on every rank.
  using AfterEach = std::function<Verdict()>;

  /// The system, bound and with drives, must outlive the driver. Collective.
  explicit TimeDriver(field::System& system, MovingSystem::Values known = {});
  virtual ~TimeDriver() = default;
  TimeDriver(const TimeDriver&) = delete;
  TimeDriver& operator=(const TimeDriver&) = delete;

  /// Steps to the end, or until `after_each` says otherwise, and returns what it said last. Throws SolverFailure when
  /// energy grows beyond the work done; u, v and the rest are then those of the last state that was found sound.
  /// Collective.
  Verdict run(const AfterEach& after_each);

  double time() const;
  int step() const;                                  ///< steps done
  double step_length() const;                        ///< [s]
  double end_time() const;                           ///< as asked for, PETSC_MAX_REAL if only steps are counted [s]
  int good_step() const { return good_.clock.step; } ///< of the last state that was found sound
  int expected_steps() const;                        ///< in all, if nothing stops the run

  /// What moves by steps of its own is asked for its rows by these: they are collective.
  ///@{
  std::span<const double> local() const { return caught_up().u; } ///< displacement [owned | halo] [m]
  std::span<const double> u() const { return {caught_up().u.data(), moving_.owned()}; }
  std::span<const double> v() const { return caught_up().v; } ///< owned [m/s]
  ///@}
  virtual std::span<const double> acceleration() const = 0; ///< owned [m/s^2]
  const MovingSystem& moving() const { return moving_; }
  Vec displacement() const { return catch_up(), displacement_.get(); }
  virtual KineticEnergy kinetic_energy() const = 0; ///< Collective.

  /// All that a run needs besides u, v and the acceleration to go on to the last bit.
  struct Clock {
    double time = 0.0;
    int step = 0;
    double length = 0.0; ///< of the step to come [s]
    StepOrigin origin;
    double work = 0.0;           ///< of this rank [J]
    double energy_bound = 0.0;   ///< what the kinetic energy is judged by [J]
    double initial = 0.0;        ///< energy at time 0 [J]
    double start_bound = 0.0;    ///< what energy_bound began with [J]
    MovingSystem::Damped damped; ///< of this rank
  };
  Clock clock() const;
  /// Between two steps. Acceleration and held force were evaluated before the bonds broke that are gone now, so they
  /// cannot be worked out again.
  field::State state() const;
  /// Goes on from a state, of this layout or carried to it. Collective.
  void resume(const Clock& clock, const field::State& state);
  /// The same where rows are new: accelerations and forces are those of u and v, which stand in `values`. Collective.
  void resume_changed(const Clock& clock);
  /// Owned u and v, to be written to before `resume_changed`.
  struct Place {
    std::span<double> u, v;
  };
  Place values() { return {told_u_, told_v_}; }
  /// u and v leave the driver, of which nothing may be asked any more. Collective.
  MovingSystem::Values give_up();
  void count_only(std::optional<std::vector<std::array<Index, 2>>> rows) { moving_.count_only(std::move(rows)); }

protected:
  /// TS of this name with what all runs have in common, and the user's -ts_... on top.
  void make_ts(const char* type);
  /// Length, or 0 without -ts_dt; refuses ends that make no sense.
  double given_step() const;
  void set_step(double length) const;
  virtual StepOrigin origin() const { return {}; }
  /// Takes over an acceleration, and where steps are counted from.
  virtual void set_acceleration(const StepOrigin& origin, std::span<const double> a) = 0;
  /// What is held is where it should be, and the acceleration follows from where all is.
  virtual void start(double time, std::span<double> a) = 0;
  /// The same where it stands, without copies.
  virtual void start_again(double time, const StepOrigin& origin);
  /// What was worked out from u besides the acceleration, after u was set.
  virtual void forces_again(double time) { (void)time; }
  /// Of a step that has parts, the length of the last one [s].
  virtual double last_part(double length) const { return length; }
  /// Books a part of a step, the last one left out, and lets bonds break.
  void part_ended(double length);
  virtual void judge_step(double length) const { (void)length; } ///< throws UserError for one that is too long
  /// What a step becomes where it was chosen for another layout, and may be too long for this one [s].
  virtual double fitting_step(double length) const { return length; }
  /// Takes internal forces that are no longer there out of the acceleration: the step that ended felt them, the next
  /// one does not.
  virtual void let_go(const field::ForceLosses& losses) = 0;
  void go_back(); ///< to the last state that was found sound
  /// u and v are those of the last step, where what moves by itself has not told them yet.
  void catch_up() const;
  void fall_behind(double length) { behind_ = length; } ///< a step of that length was made without them [s]
  virtual void after_evaluations() {}                   ///< of a step, before what may change the scene looks at it

  MovingSystem moving_;
  VecHandle displacement_, velocity_; // on moving_.u and moving_.v
  TsHandle ts_;

private:
  void after_step();
  void book_and_break(double length);
  bool sound();
  void refuse_unsound();
  int most_steps() const; ///< asked for
  void refuse_spent_run() const;
  void keep();
  const MovingSystem& caught_up() const { return catch_up(), moving_; }
  void copy_state(field::State& to) const;
  void set_state(const Clock& clock, const field::State& state);
  void set_clock(const Clock& clock, std::span<const double> held);

  double energy_bound_ = 0.0, start_bound_ = 0.0;
  mutable double behind_ = 0.0;       // [s]
  std::span<double> told_u_, told_v_; // owned, of moving_
  bool resumed_ = false;
  AfterEach after_each_;
  Verdict verdict_ = Verdict::go_on;
  field::ForceLosses losses_;
  struct Good {
    field::State state;
    Clock clock;
  } good_;
};
} // namespace pdx::solve
