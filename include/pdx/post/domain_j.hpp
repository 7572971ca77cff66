#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/fem/assembly.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/xfem/cut.hpp"

namespace pdx::post {
/// Squares around a tip, sides along x and y, by half their sides: the weight q is 1 inside the inner one and falls
/// linearly to 0 at the outer one.
struct DomainRing {
  double inner, outer;    ///< [m]
  geom::Frame frame = {}; ///< of coordinates in messages
};

/// A part of a cut cell that moves with one bilinear field.
struct PartOfCell {
  std::span<const xfem::PartPoint> points; ///< its quadrature points
  fem::ElementVector corner_values;        ///< what its field is at the corners: u_i + (H - H_i) a_i [m]
};
/// Appends the parts of a local cut cell.
using CellParts = std::function<void(Index cell, std::vector<PartOfCell>& parts)>;

/// J per unit of thickness at a tip as an integral over elements, plain and cut, with d the tip's direction:
/// J = int (P grad(q) . du/dd - W grad(q) . d) dA, P the first Piola stress (sigma for small strain).
/// [Shih, Moran and Nakamura, 1986]   [J/m^2]
/// Faces of the crack carry nothing. What lies inside the inner square does not matter: it may be a patch.
/// Throws UserError if the ring is empty, leaves the body's box or holds cells that a patch covers. Collective.
/// @param u displacement per local vertex, 2 each; vertices under a patch are not looked at [m]
/// @param parts asked for cells of Use::cut in the ring only; may be empty if there are none
double domain_j(const fem::ElasticBody& body, const crack::Tip& tip, const DomainRing& ring, std::span<const double> u,
                const CellParts& parts = {});
} // namespace pdx::post
