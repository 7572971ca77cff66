#pragma once
#include "pdx/base/tensor.hpp"

#include <cstdint>

namespace pdx::geom {
/// Uniform lattice of cell-centred sites; a value type. Site (i, j) owns the cell of side dx whose lower corner is
/// origin + (i, j) dx. Sites outside [0, count) are as good as any other for `point`: halos and ghosts live there.
template <int Dim> struct Lattice {
  Vector<Dim> origin = Vector<Dim>::Zero(); ///< lower corner of cell (0, 0)     [m]
  double dx = 1.0;                          ///< spacing                         [m]
  Site<Dim> count{};                        ///< sites per direction             [-]

  /// Where the site is: origin + (i + 1/2) dx per direction.                      [m]
  Vector<Dim> point(const Site<Dim>& site) const
  {
    Vector<Dim> x = origin;
    for (int d = 0; d < Dim; ++d) x[d] += (site[d] + 0.5) * dx;
    return x;
  }
  /// True for sites in [0, count).
  bool contains(const Site<Dim>& site) const
  {
    for (int d = 0; d < Dim; ++d)
      if (site[d] < 0 || site[d] >= count[d]) return false;
    return true;
  }
  /// Number of a site of the lattice, x fastest.
  std::int64_t number(const Site<Dim>& site) const
  {
    std::int64_t n = 0;
    for (int d = Dim - 1; d >= 0; --d) n = n * count[d] + site[d];
    return n;
  }
  /// The site with this number; inverse of `number` on [0, total()).
  Site<Dim> site(std::int64_t number) const
  {
    Site<Dim> s{};
    for (int d = 0; d < Dim; ++d) {
      s[d] = static_cast<Index>(number % count[d]);
      number /= count[d];
    }
    return s;
  }
  /// Number of sites; 64 bits, as a lattice spans all ranks.
  std::int64_t total() const
  {
    std::int64_t n = 1;
    for (int d = 0; d < Dim; ++d) n *= count[d];
    return n;
  }
};
} // namespace pdx::geom
