#pragma once

namespace pdx::law {
/// How strain follows from displacement, of elements as of bonds. small: linearised at rest. finite: of the deformed
/// shape, so that finite rotations strain nothing: Green-Lagrange strain with the same stiffness in elements (a St
/// Venant-Kirchhoff solid), s = |xi + eta| / |xi| - 1 along the deformed bond in bonds [XPD1 Eqs. 2, 5].
enum class Kinematics { small, finite };
} // namespace pdx::law
