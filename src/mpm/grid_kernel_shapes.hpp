#pragma once
#include "pdx/mpm/grid_kernel.hpp"

namespace pdx::mpm {
struct Hats;
struct MeantHats;
struct Splines;

/// `give` and `take` for one kind of shape function, each in a file of its own.
///@{
template <int Dim, class Shape>
void give_with(Processor processor, const GridRule& rule, const BodyMaterial& body, const Giving& what,
               const Vector<Dim>& push, const PointLanes<Dim>& points, const NodeView<Dim>& nodes);
template <int Dim, class Shape>
Vector<Dim> take_with(Processor processor, const GridRule& rule, const BodyMaterial& body, const Taking& what,
                      PointLanes<Dim>& points, const NodeView<Dim>& nodes);
///@}
} // namespace pdx::mpm
