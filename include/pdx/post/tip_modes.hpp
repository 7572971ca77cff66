#pragma once
#include "pdx/law/tip_field.hpp"
#include "pdx/post/domain_j.hpp"
#include "pdx/post/nonlocal_j.hpp"

namespace pdx::post {
/// What a straight crack's tip is loaded by. Opening and the slip of the left face forwards are positive.
struct TipModes {
  double opening, sliding; ///< K_I, K_II [Pa m^0.5]
  double along;            ///< T-stress, along the crack [Pa]
};

/// +1 for points left of a crack, looking the way it grows, -1 right of it. Asked behind the tip only, so that a crack
/// that is not quite straight there has known fields with their jump where it runs.
using SideOfCrack = std::function<int(const Vector<2>&)>;

/// By interaction with the known fields of law::TipLoad over a ring of elements, the ring of `domain_j`: with d the
/// tip's direction and small strains,
/// I = int (sigma grad(q) . du'/dd + sigma' grad(q) . du/dd - sigma : e' grad(q) . d) dA, K = E' I / 2, T = E' I.
/// [Yau, Wang and Corten, 1980; Kfouri, 1986]. Exact for straight cracks; refuses what `domain_j` refuses. Collective.
TipModes domain_modes(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring,
                      std::span<const double> u, const SideOfCrack& side, const CellParts& parts = {});

/// J on contours of a patch whose particles are displaced by as much more, 2 values per owned row [m].
using JWith = std::function<std::vector<ContourJ>(std::span<const double> added)>;

/// By two-state J on contours in a patch: half the difference of J with a known field added and taken away is their
/// interaction. One for each contour; the known fields are those of the continuum, so that contours a few horizons from
/// the tip are best. Collective. [Yau, Wang and Corten, 1980]
/// @param values of owned rows   @param scale about |K| of the state, so that nothing cancels [Pa m^0.5]
std::vector<TipModes> contour_modes(const pd::LatticePart<2>& part, std::size_t values, const law::Elastic& law,
                                    const crack::Tip& tip, double scale, const SideOfCrack& side, const JWith& j);
} // namespace pdx::post
