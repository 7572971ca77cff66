#pragma once
#include "pdx/post/tip_modes.hpp"
#include "pdx/record/crack_state.hpp"

#include <optional>

namespace pdx::record {
/// A scene in equilibrium. All that is pointed to must outlive it.
struct Solved {
  mesh::Mesh& mesh;
  const options::SceneOptions& options;
  const scene::PatchPlan& plan;
  const scene::Discretisation& d;
  std::span<const double> u; ///< local blocks [owned | halo] [m]
};

/// What the body is made of at a place.
const law::Elastic& law_at(const Solved& s, const Vector<2>& x);
/// The same at a tip. Throws UserError where not all in the square with these half sides is of that. Collective.
const law::Elastic& law_around(const Solved& s, const Vector<2>& tip, double half, const char* option);

std::optional<std::size_t> patch_at(const scene::PatchPlan& plan, const Vector<2>& x);

/// J and modes of a tip by what the options ask for: none if the tip is in no patch. All are collective.
///@{
/// @param density of `adapt::energy_density`, or as many zeros where only places are judged [J/m^3]
std::vector<post::ContourJ> contour_j(const Solved& s, const crack::Tip& tip, std::span<const double> density);
std::vector<post::TipModes> contour_modes(const Solved& s, const crack::Tip& tip, const post::SideOfCrack& side,
                                          std::span<const post::ContourJ> contours);
double domain_j(const Solved& s, const crack::Tip& tip);
post::TipModes domain_modes(const Solved& s, const crack::Tip& tip, const post::SideOfCrack& side);
///@}

/// Which side of its crack a place is on, looking the way an end has grown: of the line as it is now.
post::SideOfCrack side_of(const scene::Discretisation& d, const CrackEnd& end);

/// K_I, K_II and T of each tip as it is now, for a row of history.csv: by the ring of elements, else by the middle one
/// of the contours; none where they do not fit any more. Collective.
std::vector<std::optional<post::TipModes>> modes_of_tips(const Solved& s, const CrackState& state);
} // namespace pdx::record
