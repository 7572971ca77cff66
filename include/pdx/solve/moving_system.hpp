#pragma once
#include "pdx/field/parted.hpp"
#include "pdx/field/system.hpp"

#include <optional>

namespace pdx::solve {
/// Sums over all ranks. [J]
struct KineticEnergy {
  double moving = 0.0;    ///< 1/2 v.M v
  double particles = 0.0; ///< its part in the particles
  /// dt^2/8 a.M a of what is free. In a linear scene it is moving + strain energy - this that central differences
  /// balance against the work to the last digits: an oscillation of the scheme, not of the body.
  double scheme = 0.0;
};

/// A System that moves: displacement and velocity, lumped masses, what drives it and the work that does. Knows forces,
/// not how time is stepped.
class MovingSystem {
public:
  /// Displacement and velocity of owned rows, where they are known already; empty: those of the start.
  struct Values {
    std::vector<double> u, v;
  };
  /// The system, bound and with drives, must outlive this.
  explicit MovingSystem(field::System& system, Values known = {});

  field::System& system;
  std::vector<double> u;           ///< [owned | halo] [m]
  std::vector<double> v;           ///< owned [m/s]
  const std::vector<double>& mass; ///< owned rows; of a set's row that of the far half, see field::Tie [kg]
  std::size_t owned() const { return v.size(); }
  std::span<const field::Tie> ties() const { return ties_; }

  /// Refreshes the halo of u. f = internal force - loads at that time, of the owned components; both are remembered
  /// where something is held or loaded. Without what is far (`FarForces`), where Terms were parted. Collective.
  void unbalanced(double time, std::span<double> f);
  /// f += forces of Terms against the velocity, where there are any; after `unbalanced`, when v is that of half a step
  /// before. Collective.
  void add_damping(std::span<double> f);
  /// What each of `system.terms` has computed in `unbalanced` so far, without waiting for other ranks; empty before
  /// the first [s].
  std::span<const double> busy() const { return busy_; }
  /// a = -M^-1 f in place, 0 where held.
  void accelerate(std::span<double> f) const;
  /// The acceleration and the forces on what is held without internal forces that are no longer there.
  void let_go(std::span<const field::ForceLoss> losses, std::span<double> a);
  /// What is far: its owned rows, whose loads are none of ours, and what it has computed besides, by Term [s].
  ///@{
  /// @param parted of each Term; null: it is near as a whole
  void leave_far(std::vector<std::uint8_t> rows, std::vector<const field::Parted*> parted)
  {
    far_rows_ = std::move(rows);
    parted_ = std::move(parted);
  }
  void add_busy(std::size_t term, double seconds)
  {
    busy_.resize(system.terms.size(), 0.0);
    busy_[term] += seconds;
  }
  /// Internal force of what is far on each prescribed component, for `held_force` [N].
  void set_far_held(std::span<const double> force) { far_held_.assign(force.begin(), force.end()); }
  ///@}
  /// y += M x, ties included.
  void add_inertia(std::span<const double> x, std::span<double> y) const;
  /// Overwrites held components by what drives them.
  void move(double time, double* displacement) const;
  void move_velocity(double time, double* velocity) const;
  /// The same where time is stepped: the free far half of a held node stays where it is, or as fast as it is.
  void move_alone(double time, double* displacement) const;
  void move_velocity_alone(double time, double* velocity) const;
  /// How far what is held is from where it should be then, of the largest such displacement [-]. Collective.
  double astray(double time) const;

  /// Call with the state between steps: `note` before the first, `book` then `note` after each. Trapezoidal rule, for
  /// central differences exact in the energy that the scheme conserves. What is held is moved against its internal
  /// force and its own inertia.
  ///@{
  void note();
  /// @param length of the step that ended [s]
  void book(double length);
  ///@}
  double work() const { return work_; } ///< since the start, this rank's part [J]
  void set_work(double work) { work_ = work; }
  /// What damping has taken, this rank's part. Its force acts on either side of a step's end, as it was there.
  struct Damped {
    double energy = 0.0; ///< since the start [J]
    double power = 0.0;  ///< of the present force in the half step to come [W]
  };
  const Damped& damped() const { return damped_; }
  /// Call after each step, when its end has come to the acceleration that the next begins with.
  /// @param a owned [m/s^2]   @param step length of the next [s]
  void foresee_damping(std::span<const double> a, double step);
  /// Goes on from a state between steps: this rank's work, what damping took, `held_force`, and the loads of that time.
  void resume(double time, double work, const Damped& damped, std::span<const double> held_force);

  /// From now on `momentum` (where nothing is tied) and `kinetic_energy` are those of some owned rows; nothing: of all.
  void count_only(std::optional<std::vector<std::array<Index, 2>>> rows) { counted_ = std::move(rows); }
  /// Of all ranks [kg m/s]. Collective. @param v owned, as in `v`
  std::array<double, 3> momentum(std::span<const double> velocity) const;
  /// @param a owned [m/s^2]; empty: `scheme` is left at 0   @param step length [s]   Collective.
  KineticEnergy kinetic_energy(std::span<const double> a, double step) const;
  /// Strain energy, and what broken bonds and damping have taken, of all ranks; the halo of u must be fresh.
  /// Collective. [J]
  double stored_energy() const;
  /// Internal force at the last `unbalanced` where something is held, 0 on other owned components [N].
  void held_force(std::vector<double>& force) const;
  void near_held_force(std::vector<double>& force) const; ///< the same without what is far
  /// The place of the fastest row, of all ranks [m]. Collective.
  std::array<double, 3> fastest_place() const;

private:
  struct Load {
    const field::Drive* drive;
    std::vector<double> force, force_before; // [N]
    std::vector<double> u_before;            // [m]
  };
  /// A component of a node that is held while its far half is free.
  struct Loose {
    std::size_t row, set, held; ///< components, and the place among the held ones
    double factor;
  };
  std::vector<Loose> loose_halves() const;
  template <class Move> void without_far_halves(double* values, Move&& move) const;

  std::vector<std::array<Index, 2>> counted() const;
  template <std::size_t Dim> void divide_by_mass(std::span<double> f) const;
  template <std::size_t Dim> void add_squares(std::span<const double> a, double (&sums)[3]) const;
  double held_kinetic() const;
  void note_rolled(std::span<const double> f);
  std::span<const field::Roller> rollers_of(Index row) const;
  void load_at(double time);

  std::optional<std::vector<std::array<Index, 2>>> counted_;
  std::vector<field::Tie> ties_;
  std::vector<Loose> loose_;
  std::vector<Load> loads_;
  std::vector<const field::Parted*> parted_; // per Term; empty: all are near
  std::vector<std::uint8_t> far_rows_;       // 1 per owned row that is; empty: none
  std::vector<double> far_held_;             // per prescribed component; empty: none [N]
  std::vector<double> change_;               // owned, only where `let_go` meets ties [m/s^2]
  std::vector<double> held_, held_before_, held_u_before_;
  std::vector<double> rolled_; // internal force along each roller [N]
  double held_kinetic_before_ = 0.0, work_ = 0.0;
  std::vector<double> busy_; // per Term [s]
  Damped damped_;
  double power_ = 0.0;                           // of damping in the half step that ended [W]
  std::vector<double> damping_, all_velocities_; // owned [N]; [owned | halo] [m/s]
};
} // namespace pdx::solve
