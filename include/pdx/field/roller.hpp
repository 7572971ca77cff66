#pragma once
#include "pdx/base/tensor.hpp"

#include <span>

namespace pdx::field {
/// A direction along which a row does not move, while it is free across it. Several of one row are perpendicular to
/// each other. With the projector P on what is free, equations are P K P u = P f, symmetric as K is, and unknowns stay
/// displacements along the axes.
struct Roller {
  Index row = 0;                                   ///< local
  Vector<3> along = Vector<3>::Zero();             ///< unit vector; in the plane the third is 0
  double part(int dim, const double* values) const ///< of the values of all rows
  {
    double sum = 0.0;
    for (int a = 0; a < dim; ++a) sum += along[a] * values[row * dim + a];
    return sum;
  }
  void add(int dim, double by, double* values) const
  {
    for (int a = 0; a < dim; ++a) values[row * dim + a] += by * along[a];
  }
};

/// Takes what lies along the rollers out of values, dim per row.
inline void project(std::span<const Roller> rollers, int dim, double* values)
{
  for (const Roller& roller : rollers) roller.add(dim, -roller.part(dim, values), values);
}
} // namespace pdx::field
