#pragma once
#include "pdx/field/history.hpp"
#include "pdx/geom/box.hpp"
#include "pdx/track/tracker.hpp"

#include <optional>
#include <string>

namespace pdx {
class Options;
}

namespace pdx::options {
/// statics: a path of equilibria. explicit_dynamics: central differences. implicit_dynamics: generalised alpha.
enum class Analysis { statics, explicit_dynamics, implicit_dynamics };

/// When `checkpoint.h5` is written, besides on SIGTERM and SIGUSR1, and which one a run goes on from.
struct CheckpointOptions {
  int interval = 0;     ///< steps; 0: never
  double seconds = 0.0; ///< wall time; 0: never [s]
  std::string restart;  ///< file; empty: from the start

  bool any() const { return interval > 0 || seconds > 0.0 || !restart.empty(); }
  static CheckpointOptions read();
};

/// What patches do while cracks grow. expand: elements ahead become particles.
enum class Adapt { none, expand, relocate };

/// What makes bulk become particles besides bonds that broke: what it bears itself.
struct Triggers {
  bool damage = true;      ///< bonds that broke near
  bool connection = false; ///< bonds that a crack given from the start cuts, or that would be overstretched
  bool stress = false, stretch = false;
  double largest_stress = 0.0; ///< principal stress [Pa]
  double stretch_share = 0.8;  ///< of the critical stretch [-]
  int margin = 2;              ///< cells around
  bool any() const { return connection || stress || stretch; }
  static bool are_given(); ///< any of them, with -adapt: known before options are read
};

/// When a scene changes its layout.
struct LayoutOptions {
  int renew_interval = 0; ///< steps after which all is built anew as it was, to show that it changes nothing; 0: never
  std::optional<geom::Box<2>> renew_box; ///< cells that change hands then: a diagnostic [m]
  double rebalance_threshold = 0.0;      ///< busiest rank over the mean, above which cells are dealt out anew; 0: never
  Adapt adapt = Adapt::none;
  double critical_length = 0.0;    ///< damage as near to elements moves the border; 0: by horizon and elements [m]
  double expansion_length = 0.0;   ///< elements as near to such damage become particles; 0: likewise [m]
  double contraction_length = 0.0; ///< particles as far from all tips become elements again; 0: likewise [m]
  int adapt_interval = 1;          ///< steps from one look for such damage, or what bulk bears, to the next
  Triggers triggers;
  int hand_back = 0;            ///< steps after which quiet particles of converted bulk become bulk again; 0: never
  bool stops_at_border = false; ///< where patches stay: does the run end when a crack comes to elements?
  track::Tracker tracker = track::Tracker::sides; ///< how cracks are followed that elements take over
  int expansions = 1;                             ///< after so many a patch hands back what lies behind [XPD2 Eq. 15]

  bool patches_move() const { return adapt != Adapt::none || renew_box; }
  bool may_change(int ranks) const
  {
    return patches_move() || renew_interval > 0 || (rebalance_threshold > 0.0 && ranks > 1);
  }
  static LayoutOptions read();
};

/// How a scene moves in time, besides PETSc's own -ts_...
struct TimeOptions {
  Analysis analysis = Analysis::statics;
  double safety = 0.9; ///< share of the stable limit that a step takes by itself [-]
  bool allow_unstable = false;
  int subcycle = 1; ///< steps of particles in one of elements away from them
  CheckpointOptions checkpoint;

  bool dynamic() const { return analysis != Analysis::statics; }
  static TimeOptions read();
};

/// The history of the boundary condition with this stem ("-bc_top"), none if it has none.
/// Throws UserError for numbers that make no history and a table that cannot be read.
std::optional<field::History> read_history(Options& o, const std::string& stem);
} // namespace pdx::options
