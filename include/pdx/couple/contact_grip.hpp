#pragma once
#include "pdx/couple/contact_touch.hpp"

#include <optional>

namespace pdx::couple {
/// Material point of a skin that a touching point sticks to.
template <int Dim> struct Grip {
  Index point = 0, body = 0;         ///< the point, and the body of the skin
  std::array<Index, Dim> points{};   ///< of the facet that is touched
  std::array<double, Dim> weights{}; ///< theirs, with sum 1; a little beyond it some are negative
  double stretch = 0.0;              ///< |tau| at the end of the last step [m]
};

/// Coulomb friction of a touch: a spring k from the grip to the point along the facet that is touched, of energy
/// k |tau|^2 / 2. The grip slips where |tau| would be beyond its limit. Forces are the derivatives of that energy, the
/// tilt of the facet included: they neither push nor turn the two bodies as a whole.
template <int Dim> struct Traction {
  Grip<Dim> grip;                        ///< as it is now
  Vector<Dim> tau;                       ///< from the grip to the point along the facet [m]
  double slip_energy = 0.0;              ///< that giving way took, by the trapezoidal rule, over k [m^2]
  Vector<Dim> normal;                    ///< of the facet, on the side of the point
  double height = 0.0;                   ///< of the point above the grip along the normal [m]
  std::array<Vector<Dim>, Dim> slopes{}; ///< gradients of the facet's weights along it [1/m]

  /// Adds the derivatives of the energy.
  /// @param stiffness k [N/m]   @param forces of all points [N]
  void add_forces(double stiffness, std::span<Vector<Dim>> forces) const;
};

/// None where the skin is no face: what is touched alone does not rub. A point that comes to another facet takes its
/// traction along: tau turns with the normal.
/// @param before the grip at the end of the last step, or null if the touch is new   @param limit of |tau| [m]
template <int Dim>
std::optional<Traction<Dim>> traction_of(const ContactSkin<Dim>& skin, const Touch<Dim>& touch,
                                         std::span<const Vector<Dim>> x, Index point, const Grip<Dim>* before,
                                         double limit);
} // namespace pdx::couple
