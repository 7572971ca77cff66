#pragma once
#include "pdx/geom/frame.hpp"
#include "pdx/pd/bond_term.hpp"

namespace pdx::post {
/// A square with sides along x and y. It is moved to the nearest lines half-way between particle columns and rows.
struct SquareContour {
  Vector<2> centre; ///< [m]
  double side;      ///< [m]
};

/// J of a contour as it was taken.
struct ContourJ {
  double j;    ///< [J/m^2]
  double side; ///< after the contour was moved to half-way lines; mean of x and y [m]
};

/// A patch in equilibrium.
struct PatchState {
  MPI_Comm comm;
  const pd::LatticePart<2>& part;
  law::Kinematics kinematics;
  std::span<const double> u;       ///< owned rows * 2 at least [m]
  std::span<const double> density; ///< strain energy density per owned row, with the share of carried bonds [J/m^3]
  /// Particle columns that stay between a contour and the border of the patch, at least 1. Where bonds cross the border
  /// it must be the stencil's reach: the sum below knows bonds between particles only.
  int margin = 1;
  geom::Frame frame = {}; ///< of coordinates in messages
};

/// Nonlocal J per unit of thickness in the (unit) direction d that the crack grows in, on each contour:
/// J = sum_contour W n.d dx - 1/2 sum_{i inside} sum_{j outside} f_ij . (u'_i + u'_j) / t, f_ij the force of j on i [N]
/// as in the solver, u' the derivative along d. [XPD1 Eq. 30, where the factor 1/2 is missing]
/// Derivatives are central differences, one-sided where the bond to a neighbour is broken or missing. Broken bonds
/// carry nothing and store nothing. W between two columns is formed from the product of their stretches, 1/4 sum kappa
/// xi s s+ (the mean of the columns' W less 1/8 sum dF . d(eta)). The sums over a column then telescope: J of linear
/// bonds in equilibrium is the same on every contour around a straight crack along x or y, to rounding, where families
/// are whole and the tip is more than a reach away. Throws UserError, naming the largest side that fits, for a contour
/// that leaves the patch or its margin. Collective; the same on any number of ranks.
std::vector<ContourJ> nonlocal_j(const PatchState& state, const Vector<2>& direction,
                                 std::span<const SquareContour> contours);
} // namespace pdx::post
