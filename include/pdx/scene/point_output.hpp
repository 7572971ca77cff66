#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/mpm/point_term.hpp"
#include "pdx/scene/point_plan.hpp"

#include <functional>

namespace pdx::scene {
/// A cell of a body's grid.
template <int Dim> struct CellOfBody {
  Index body = 0;
  Site<Dim> at{};
};

/// What points show: displacement [m] and velocity [m/s], Dim each, Cauchy stress [Pa] and deformation gradient [-],
/// row by row, and the number of the body.
struct PointFields {
  std::vector<double> displacement, velocity, stress, deformation;
  std::vector<Index> body;
};

/// Adds them to a block whose points they are of.
template <int Dim> void add_point_fields(const PointFields& fields, int rank, field::OutputBlock& block);

/// Fields of the points of a Term, whose cells these are.
/// @param local displacement [owned | halo] [m]   @param velocity likewise [m/s]
/// @param is_there does a cell of the plan have its points, on any rank? Alike on every rank.
template <int Dim>
field::OutputBlock point_block(const PointPlan<Dim>& plan, std::span<const CellOfBody<Dim>> cells,
                               const mpm::PointTerm<Dim>& term, std::span<const double> local,
                               std::span<const double> velocity, int rank,
                               const std::function<bool(const CellOfBody<Dim>&)>& is_there);
} // namespace pdx::scene
