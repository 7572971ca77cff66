#pragma once
#include "pdx/fem/elastic_kernel.hpp"

/// Five distorted cells that fill a rectangle of 0.24 m x 0.12 m: vertices 0-3 on its corners, 4-7 inside
/// (MacNeal and Harder 1985, "A proposed standard set of problems", membrane patch).
struct Patch {
  std::array<pdx::Vector<2>, 8> points{
      {{0.0, 0.0}, {0.24, 0.0}, {0.24, 0.12}, {0.0, 0.12}, {0.04, 0.02}, {0.18, 0.03}, {0.16, 0.08}, {0.08, 0.08}}};
  std::array<std::array<int, 4>, 5> cells{{{0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 5, 6, 7}}};

  pdx::fem::Corners corners(const std::array<int, 4>& cell) const
  {
    return {points[cell[0]], points[cell[1]], points[cell[2]], points[cell[3]]};
  }
  /// Corner values of the field u(x) = shift + gradient x.
  pdx::fem::ElementVector linear(const std::array<int, 4>& cell, const pdx::Tensor<2>& gradient,
                                 const pdx::Vector<2>& shift = pdx::Vector<2>::Zero()) const
  {
    pdx::fem::ElementVector d;
    for (int a = 0; a < 4; ++a) d.segment<2>(2 * a) = shift + gradient * points[cell[a]];
    return d;
  }
};
