#pragma once
#include "pdx/geom/box.hpp"

#include <string>

namespace pdx::geom {
/// Where the coordinates of a scene begin, and how finely they are told apart. Users put a body anywhere; inside, all
/// coordinates are counted from its lower corner and rounded to a decimal grid that is coarser than what the place
/// takes from the digits of a number: a scene that is moved as a whole is the same scene to the last bit, if its own
/// coordinates are decimals, and else to one step of the grid.
class Frame {
public:
  Frame() = default; ///< nothing is moved or rounded
  /// @param body as given [m]
  explicit Frame(const Box<3>& body);
  explicit Frame(const Box<2>& body);

  Vector<2> inside(const Vector<2>& given) const { return moved<2>(given); }
  Vector<3> inside(const Vector<3>& given) const { return moved<3>(given); }
  Box<2> inside(const Box<2>& given) const { return {inside(given.lower), inside(given.upper)}; }
  template <int Dim> Vector<Dim> given(const Vector<Dim>& inside) const { return inside + origin_.head<Dim>(); }
  std::string text(const Vector<2>& inside) const; ///< "(x, y)" as the user gave it

  const Vector<3>& origin() const { return origin_; } ///< [m]
  /// Step of the grid: the power of ten above 2 units in the last place of the body's coordinates and above 1e-14 of
  /// its size. 0 where nothing is rounded. [m]
  double step() const { return steps_per_unit_ > 0.0 ? 1.0 / steps_per_unit_ : 0.0; }

private:
  template <int Dim> Vector<Dim> moved(const Vector<Dim>& given) const
  {
    Vector<Dim> x = given - origin_.head<Dim>();
    for (int d = 0; d < Dim; ++d) x[d] = rounded(x[d]);
    return x;
  }
  double rounded(double x) const;

  Vector<3> origin_ = Vector<3>::Zero(); // [m]
  double steps_per_unit_ = 0.0;          // a power of ten [1/m]
};
} // namespace pdx::geom
