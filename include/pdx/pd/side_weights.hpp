#pragma once
#include "pdx/pd/stencil.hpp"

#include <optional>
#include <vector>

namespace pdx::pd {
/// Factors of bonds beside a straight free side of a square lattice, which runs half a spacing outside the outermost
/// row: one for each row of the bond's nearer end and each arm, shared by both ends of the bond, so that momentum
/// holds. They are as near to 1 as they can be (least sum of mu kappa xi (w - 1)^2, mu arms alike, 0.2 <= w <= 3) with
/// 1. all uniform strains exact, with the traction on the outermost row: through every plane between two rows pass the
///    forces of the bulk, sum mu w kappa n_y^3 and sum mu w kappa n_x^2 n_y;
/// 2. tension along the side exact, in sum (2) and its first moment (3), and bending right at every height (4): with
///    k = mu kappa xi n_x^2 (n_x^2 - nu n_y^2), y = row + a_y/2 + 1/2 the middle of a bond and a_y the rows it spans,
///    sum k (w - 1) = sum k a_y/2, sum k (w - 1) y = sum k (3 a_y^2 - 1)/24, sum k (w - 1) y^2 = sum k (a_y^3 -
///    a_y)/24.
/// A lattice bends by forces at its rows, which lack the bending of the rows themselves, 1/n^2 of n rows; with (3) the
/// tension beside either side lies by 1/24 of a spacing's force further out and makes up for it. Where elements take
/// the tension over they must find it where it is: there (3) asks that the forces which pass a line
/// across the side have the moment of a uniform traction, and n rows bend by about 1/n^2 too easily.
/// Where no factors do all that (uniform micromodulus, 5 dx and more), 1 is asked of tension along the side only, the
/// state that leaves it free: sum mu w kappa n_y (n_x^2 - nu n_y^2) = 0.
class SideWeights {
public:
  enum class Aim {
    bending, ///< for particles that stand alone
    traction ///< for a patch among elements
  };
  /// Nothing where no factors do even that.
  static std::optional<SideWeights> solve(const Stencil<2>& stencil, Aim aim);

  /// Rows from the side in which bonds begin that have a factor: the stencil's reach.
  int rows() const { return rows_; }
  /// @param row of the nearer end, 0 the outermost   @param along, across  sites that the bond spans, at least 0    [-]
  double at(int row, int along, int across) const { return row < rows_ ? factors_[place(row, along, across)] : 1.0; }
  /// Of a bond that spans so many sites, by the axis across the side.
  double at(int row, const Site<2>& step, std::size_t axis) const
  {
    return at(row, std::abs(step[1 - axis]), std::abs(step[axis]));
  }
  bool all_strains() const { return all_strains_; } ///< 1. holds for all uniform strains

private:
  SideWeights(int rows, bool all_strains)
      : rows_(rows), all_strains_(all_strains), factors_(static_cast<std::size_t>(rows * (rows + 1) * (rows + 1)), 1.0)
  {}
  std::size_t place(int row, int along, int across) const
  {
    return static_cast<std::size_t>((row * (rows_ + 1) + along) * (rows_ + 1) + across);
  }

  int rows_;
  bool all_strains_;
  std::vector<double> factors_;
};

/// How a long bar of `rows` rows answers over how its material would, E t W and E t W^3 / 12: 1 where it is right. [-]
struct BarStiffness {
  double tension = 1.0, bending = 1.0;
};
/// @param weights of both its sides, multiplied where they meet; nullptr: no correction
BarStiffness bar_stiffness(const Stencil<2>& stencil, const SideWeights* weights, int rows);
} // namespace pdx::pd
