#pragma once

namespace pdx::mpm {
/// When stress follows in a step on a grid that is made anew each step.
/// usf: first, with the velocity that points bring. usl: last, with the velocity that forces gave the grid.
/// musl: last, with the velocity that points bring when they have been moved [PDMPM Eqs. 33-49].
enum class Order { musl, usl, usf };

/// How points and nodes see each other: hats; hats meant over the square or cube of a point's reference (uGIMP);
/// quadratic B-splines.
enum class Shape { hat, gimp, bspline };

/// Nodes along an axis that a point sees.
constexpr int reach_of(Shape shape) { return shape == Shape::hat ? 2 : 3; }

struct GridRule {
  Order order = Order::musl;
  Shape shape = Shape::hat;
  double pic = 0.0;  ///< share of the grid's own velocity that points take, not just of its change [-]
  double side = 0.0; ///< h of a cell [m]
  bool late = true;  ///< musl: points move with the velocity that strains them, not with that of before [PDMPM Eq. 41]
};
} // namespace pdx::mpm
