#pragma once
#include "pdx/base/tensor.hpp"

#include <bit>
#include <cstdint>
#include <vector>

/// Hat functions of a square or cubic cell at the sites of its points, and what they leave without stiffness.
namespace pdx::mpm {
template <int Dim> inline constexpr int kCorners = 1 << Dim;
/// One value per corner, x fastest.
template <int Dim> using CornerValues = Eigen::Matrix<double, kCorners<Dim>, 1>;
/// d N_I / d X_d at (I, d) [1/m].
template <int Dim> using CornerGradients = Eigen::Matrix<double, kCorners<Dim>, Dim>;

/// All sites of a cell are points.
template <int Dim> constexpr std::uint64_t full_mask(int ratio)
{
  int sites = 1;
  for (int d = 0; d < Dim; ++d) sites *= ratio;
  return sites == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << sites) - 1;
}

/// Place of site k in its cell, in sides of the cell from the lowest corner: (i + 1/2) / ratio in each direction.
template <int Dim> Vector<Dim> site_place(int ratio, int k)
{
  Vector<Dim> place;
  for (int d = 0; d < Dim; ++d, k /= ratio) place[d] = (k % ratio + 0.5) / ratio;
  return place;
}

/// N_I at a place, in sides of the cell.
template <int Dim> CornerValues<Dim> hat_values(const Vector<Dim>& place)
{
  CornerValues<Dim> n;
  for (int a = 0; a < kCorners<Dim>; ++a) {
    n[a] = 1.0;
    for (int d = 0; d < Dim; ++d) n[a] *= a >> d & 1 ? place[d] : 1.0 - place[d];
  }
  return n;
}

template <int Dim> CornerGradients<Dim> hat_gradients(const Vector<Dim>& place, double side)
{
  CornerGradients<Dim> g;
  for (int a = 0; a < kCorners<Dim>; ++a)
    for (int d = 0; d < Dim; ++d) {
      g(a, d) = (a >> d & 1 ? 1.0 : -1.0) / side;
      for (int e = 0; e < Dim; ++e)
        if (e != d) g(a, d) *= a >> e & 1 ? place[e] : 1.0 - place[e];
    }
  return g;
}

/// Calls visit(k) for every point of a mask, in order of sites.
template <class Visit> void for_each_point(std::uint64_t mask, Visit&& visit)
{
  for (; mask; mask &= mask - 1) visit(std::countr_zero(mask));
}

/// Shapes of a cell that a linear displacement is blind to: signs of xy in the plane, of xy, yz, zx and xyz in space.
template <int Dim> inline constexpr int kHourglasses = Dim == 2 ? 1 : 4;
constexpr double hourglass_sign(int mode, int corner)
{
  constexpr int axes[4] = {0b011, 0b110, 0b101, 0b111};
  return std::popcount(static_cast<unsigned>(~corner & axes[mode])) % 2 ? -1.0 : 1.0;
}
} // namespace pdx::mpm
