#pragma once
#include "pdx/adapt/fill.hpp"
#include "pdx/field/row_move.hpp"
#include "pdx/field/state.hpp"
#include "pdx/scene/crack_notes.hpp"
#include "pdx/scene/dormant.hpp"
#include "pdx/scene/handed.hpp"
#include "pdx/scene/scene_names.hpp"
#include "pdx/solve/time_driver.hpp"

namespace pdx::scene {
/// What a CrackWatch has seen, by names of particles.
struct NamedCracks {
  std::int64_t bonds_broken = 0; ///< at the last look
  double time = 0.0, largest_speed = 0.0;
  std::vector<field::RowName> arrivals; ///< of all ranks, in order of looks
  std::vector<double> arrival_times;    ///< of each [s]
  std::vector<int> per_look;            ///< how many of them each look saw
  std::vector<double> damage; ///< at the last look, one for each of `NamedState::particles`; below 0: not looked at yet
};

/// All that a scene has come to, by names that outlive its ranks and its layout: what another layout, a checkpoint and
/// a restarted run take of it. The lists of a rank may be those of what it owns, or any share of all.
struct NamedState {
  int dim = 2;
  std::vector<field::RowName> rows; ///< RowName() for none
  bool in_time = false;
  field::State moving; ///< of `rows`; in statics the displacement alone, put there by who asks for it
  std::vector<field::RowName> particles;
  int words_per_particle = 0;      ///< 0 where nothing can break
  std::vector<std::uint64_t> gone; ///< bonds that broke or were cut, so many words for each of `particles`
  /// Names of carried bonds that broke, of all ranks, ascending; none where there are no carried bonds.
  std::optional<std::vector<std::uint64_t>> carried;
  std::optional<NamedGrips> grips;   ///< of all ranks; none where nothing rubs
  std::optional<NamedCracks> cracks; ///< as a CrackWatch has seen them; none without one
};

/// What a scene owns, without what moves. Collective.
NamedState capture(const Standing& scene);
/// What is known of a scene in time.
enum class Moves {
  all,   ///< acceleration and forces that hold too
  alone, ///< displacement and velocity: from these a changed layout works out the rest
};
/// The same of a scene in time. Collective.
NamedState capture(const Standing& scene, const solve::TimeDriver& driver, const std::optional<CrackNotes>& cracks,
                   Moves moves = Moves::all);
/// The same of a scene that is handed over: what broke of carried bonds and what rubs, of rows nothing. Collective.
NamedState capture_around(const Standing& scene);
/// What goes on of a scene that is handed over, in order of its rows: u, v, and what a CrackWatch has seen.
struct Passing {
  solve::MovingSystem::Values values;
  std::optional<CrackNotes> cracks;
  Index first_particle = 0; ///< local row
};
/// Adds what the rows had that do not stay. @param before of all rows, which becomes that of the rows now
void add_leaving(NamedState& state, const Standing& now, const Handed& handed, Passing& before);

/// Adds rows that the next layout will have to what a scene in the plane owns.
/// @param fresh displacement, velocity; nodes or particles, of which nothing is broken
void add_rows(NamedState& state, const adapt::FreshRows& fresh);

/// Why a state does not fit a scene, and in which table of a checkpoint that stands.
struct Misfit {
  const char* table = "";
  std::string why; ///< empty: it fits
};

/// The way of a state to a scene, which may have other ranks and another layout. All methods are collective.
class StateMove {
public:
  /// Where a state comes from.
  enum class From {
    file,    ///< as may be, of any ranks
    same,    ///< this run, under the same layout
    changed, ///< this run, under another layout
  };
  /// All must outlive this. @param stay rows of this scene of which the state knows nothing; null: none
  StateMove(const NamedState& state, const Standing& scene, From from = From::file,
            const field::StayingRows* stay = nullptr);
  const Misfit& misfit() const { return misfit_; } ///< nothing below may be asked for what does not fit

  /// The scene's rows that come from behind the first so many of the state's on its rank, ascending.
  std::vector<Index> came_after(std::size_t known) const;
  std::span<const Index> rows() const { return coming_; } ///< of the scene, that the state is about; ascending
  /// Values of these. @param values of the state's rows x components
  std::vector<double> rows(std::span<const double> values, int components) const;
  /// Breaks the bonds that are broken there.
  void break_bonds() const;
  /// Friction holds points where it held them there.
  void hold_grips() const;
  field::State moving() const;
  std::optional<CrackNotes> cracks() const;
  /// Damage of the particles that the state is about, among that of all.
  void place_damage(std::vector<double>& damage) const;

  /// What the scene has no place for.
  Dormant dormant() const;

  /// Throws std::logic_error for what does not fit: between two layouts of one run nothing may be lost.
  void require_fit() const;

private:
  Misfit misfit_of() const;

  const NamedState& state_;
  Standing scene_;
  bool changed_;
  std::vector<Index> coming_;
  SceneNames names_;
  field::RowMove rows_, particles_;
  Misfit misfit_;
};
} // namespace pdx::scene
