#pragma once
#include "pdx/pd/stencil.hpp"

#include <optional>
#include <vector>

namespace pdx::pd {
/// `SideWeights` of a cubic lattice: factors of bonds beside a plane free side along its layers, one for each layer of
/// the bond's nearer end and each arm, next to 1 (as there) with
/// 1. all planes between two layers at rest where uniform strain leaves the side free, e_z = -c12 / c11 (e_x + e_y);
/// 2. the energies of all uniform strains those of the solid up to the side, half a spacing outside the outermost
///    layer, so that it does not matter whether what is free may contract: with k = mu kappa xi, sum k (w - 1) of n =
///    sum of k a_z / 2 of n for n = n_x^4, n_x^2 n_y^2, n_x^2 n_z^2 (and with 1. n_z^4);
/// 3. of the tension that passes a plane across the side in the state 1., stretched along it or across, the first and
///    second moment, as of `SideWeights`: `Aim` says which first moment.
/// In the plane all uniform strains are in balance with the traction on the outermost row, which in space leaves too
/// little for 2.: one half of the outermost layer contracts or the other.
/// Between two sides of less than `thick` layers factors are solved for all layers at once, as both sides see each
/// other's bonds: all of 1. to 3., or of 1. and 2., or, where that cannot be had, the product of both.
class SolidSides {
public:
  enum class Aim {
    bending, ///< for particles that stand alone
    traction ///< for a patch beside points
  };
  /// Nothing where no factors do that.
  static std::optional<SolidSides> solve(const Stencil<3>& stencil, Aim aim);

  /// Layers from a side in which bonds begin that have a factor: the stencil's reach.
  int rows() const { return rows_; }
  /// Layers between two sides from which on they do not see each other.
  int thick() const { return 3 * rows_; }
  /// Of one side.
  /// @param row of the nearer end, 0 the outermost   @param step of the bond   @param axis across the side        [-]
  double at(int row, const Site<3>& step, std::size_t axis) const
  {
    return row < rows_ ? half_[place(row, step, axis)] : 1.0;
  }
  /// Of both sides of so few layers; nothing where the product of `at` is to be taken.
  /// @param row of the end nearer to a side
  std::optional<double> between(int layers, int row, const Site<3>& step, std::size_t axis) const
  {
    if (layers >= thick() || thin_[static_cast<std::size_t>(layers)].empty()) return std::nullopt;
    return row < rows_ ? thin_[static_cast<std::size_t>(layers)][place(row, step, axis)] : 1.0;
  }

private:
  explicit SolidSides(int rows) : rows_(rows), thin_(static_cast<std::size_t>(3 * rows)) {}
  std::size_t place(int row, const Site<3>& step, std::size_t axis) const
  {
    std::size_t at = static_cast<std::size_t>(row);
    for (const std::size_t d : {(axis + 1) % 3, (axis + 2) % 3, axis})
      at = at * static_cast<std::size_t>(rows_ + 1) + static_cast<std::size_t>(std::abs(step[d]));
    return at;
  }

  int rows_;
  std::vector<double> half_;
  std::vector<std::vector<double>> thin_; ///< by layers
};

/// How a long bar of so many layers across answers to tension over how its material would, E: 1 where it is right. [-]
/// @param sides of all its sides, multiplied where they meet; nullptr: no correction
double bar_tension(const Stencil<3>& stencil, const SolidSides* sides, const std::array<int, 2>& layers);
} // namespace pdx::pd
