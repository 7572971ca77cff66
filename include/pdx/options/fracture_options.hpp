#pragma once
#include "pdx/couple/fracture.hpp"
#include "pdx/crack/crack_set.hpp"
#include "pdx/law/scatter.hpp"
#include "pdx/pd/toughness.hpp"
#include "pdx/xfem/enrichment.hpp"

#include <optional>

namespace pdx::options {
/// The cracks that are there from the start: `-crack_...`, and how elements carry them: `-xfem_...`.
struct CrackOptions {
  std::vector<crack::Polyline> lines; ///< [m]
  xfem::EnrichmentRule rule;

  static CrackOptions read();
};

/// When bonds break; without a toughness nothing ever breaks and nothing is paid for it.
struct FractureOptions {
  std::optional<double> toughness;        ///< energy release rate Gc, by which critical stretches are told [J/m^2]
  std::optional<double> critical_stretch; ///< instead of it [-]
  bool rest_breaks = true; ///< false: `toughness` is that of a region, and nothing breaks outside regions
  pd::Toughness by = pd::Toughness::lattice;
  std::vector<geom::Box<2>> no_fail; ///< bonds with an end in one of them never break [m]
  couple::Release release = couple::Release::all;
  double release_share = 0.1;
  law::Scatter scatter; ///< of critical stretches

  bool active() const { return toughness || critical_stretch; }
  /// @param usual toughness of a material by name
  static FractureOptions read(std::optional<double> usual);
};

/// Are elements that do not change condensed onto those that particles touch?
enum class Condense { automatic, on, off };

/// The path of a quasi-static load.
struct LoadOptions {
  int steps = 1;
  int halvings = 6;
  int passes = 1000;
  double broken_share = 0.05; ///< of all bonds in one step, above which it is halved
  Condense condense = Condense::automatic;

  static LoadOptions read();
};

/// What is worked out of the result.
struct PostOptions {
  bool reference_fe = false;
  std::vector<double> j_contours;                ///< sides of the square contours [m]
  std::optional<Vector<2>> j_centre;             ///< instead of the crack's tip [m]
  std::optional<std::array<double, 2>> j_domain; ///< half-widths of the ring of elements [m]
  bool modes = false;                            ///< K_I, K_II and T apart, wherever J is worked out
  bool energy_release = false;
  bool precrack_as_damage = false;
  int section = -1;         ///< axis across which the first broken section is looked for; -1: none
  double tip_damage = 0.35; ///< of a particle beside a crack, see track::CrackTracker [-]

  bool any_j() const { return !j_contours.empty() || j_domain || energy_release; }
  static PostOptions read();
};
} // namespace pdx::options
