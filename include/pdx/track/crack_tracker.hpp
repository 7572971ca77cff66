#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/law/elastic.hpp"
#include "pdx/track/crack_tree.hpp"

#include <functional>
#include <mpi.h>

namespace pdx::track {
/// What the tracker saw at its last look, all ranks alike.
struct CrackNow {
  double grown = 0.0; ///< length of all tips and branches, from the given cracks on [m]
  double speed = 0.0; ///< of the fastest tip [m/s]
  int tips = 0;
};

/// Follows the cracks that grow from the tips given in patches: tips, lengths, speeds, branches. A particle counts to a
/// crack from when its damage, the precrack's bonds included, comes to a threshold; between two looks that moment is
/// interpolated. The share of the bonds that a straight crack takes from the particles beside it is 0.39 (3 spacings in
/// a horizon) to 0.46 (6), so that a threshold below sees the crack within a horizon behind the last broken bond.
/// Only reads; what it keeps between looks is a number per particle and the names of the damaged ones, which it knows
/// also when they are gone.
class CrackTracker {
public:
  /// @param tips      with the direction straight on
  /// @param grounds   one per lattice
  /// @param threshold damage of a particle beside a crack [-]
  CrackTracker(MPI_Comm comm, std::span<const crack::Tip> tips, std::vector<TreeGround> grounds, double threshold);

  using NameOf = std::function<std::uint64_t(std::size_t)>;
  /// Looks at the damage, precrack included [XPD1 Eq. 9], of the owned particles: the first time at what is broken from
  /// the start. Particles must be the same each time; who has others resumes another tracker. Collective.
  /// @param name of the site of a particle (TreeGround::names), by its place in `damage`
  void look(double time, std::span<const double> damage, const NameOf& name);

  /// Have particles come with another layout, on any rank? Collective.
  bool has_new() const;
  std::vector<std::size_t> new_ones() const; ///< this rank's, ascending
  /// They begin with the damage they have: what they lose from here arrives.
  /// @param damage as of `look`, of `new_ones`
  void note_new(std::span<const double> damage);

  /// A look at a time until which no bond broke since the last look.
  void nothing_new(double time);

  /// All that goes on from here, to the last bit.
  struct State {
    double time = 0.0, largest_speed = 0.0;
    std::vector<Arrival> arrivals; ///< of all ranks, in order of looks
    std::vector<int> per_look;     ///< how many of them each look saw that saw any
    std::vector<double> damage;    ///< of the owned particles at the last look; empty: the next look begins anew;
                                   ///< below 0: of a particle that is new, as one at the first look
  };
  State state() const;
  /// For a tracker that has not looked yet; `now().speed` is known after the next look. Alike on every rank but for the
  /// damage.
  void resume(State state);

  const CrackNow& now() const { return now_; }
  double largest_speed() const { return largest_speed_; } ///< of any tip at any look [m/s]
  const CrackTree& tree() const { return tree_; }

private:
  void judge(double time);

  MPI_Comm comm_;
  double threshold_;
  CrackTree tree_;
  std::vector<int> per_look_;  // arrivals of each look that saw any
  std::vector<double> before_; // damage at the last look; empty before the first
  double time_ = 0.0;
  CrackNow now_;
  std::vector<GrownTip> tips_; // at the last look that saw something new
  double largest_speed_ = 0.0;
};
} // namespace pdx::track
