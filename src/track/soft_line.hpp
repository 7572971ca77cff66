#pragma once
#include "lattice_units.hpp"

namespace pdx::track {
/// A particle that should lie on one side of a line.
struct Labelled {
  Vector<2> at; ///< in spacings
  double side;  ///< +1 left of the line, -1 right
  double weight;
};

/// How much a line withstands being moved (per square of a spacing) and turned.
struct Stiffness {
  double offset = 0.0, slope = 0.0;
};

/// The line near `line` with the best margin between particles that are labelled: the least weighted
/// sum log(1 + exp(-side offset / margin)), plus half the stiffness times the squares of offset at `line.at` and slope.
/// Exact labels of a straight crack give it to some hundredths of a spacing.
Line soft_line(std::span<const Labelled> points, const Line& line, const Stiffness& stiffness);
} // namespace pdx::track
