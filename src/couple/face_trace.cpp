#include "pdx/couple/face_trace.hpp"

#include "pdx/geom/line_pieces.hpp"

#include <cmath>

namespace pdx::couple {
namespace face_trace {
constexpr double kOnLine = 1e-9; // spacings

/// At a point of the surface of the unit cube around 0: the field x y z, which is y z / 2 on the side x = 1/2, and what
/// the bubble adds to it.
struct Twist {
  double product = 0.0, bubble = 0.0;
};
Twist twist(const Vector<3>& x)
{
  Twist twist{x.prod(), 0.0};
  Eigen::Index sides = 0, on = 0;
  for (Eigen::Index d = 0; d < 3; ++d)
    if (std::abs(std::abs(x[d]) - 0.5) < kOnLine) {
      ++sides;
      on = d;
    }
  if (sides == 1) twist.bubble = x[on] * face_bubble(x[(on + 1) % 3], x[(on + 2) % 3]);
  return twist;
}
} // namespace face_trace

/// The work of all bonds through a lattice cell, stretched by a shear in the plane of y and z, on a displacement along
/// x that is x y z in it: 0 in a uniform solid. Bonds of one arm through any cell are those of one bond through all
/// cells that it passes; at its ends, the middles of cells, the field is 0.
double face_share(const pd::Stencil<3>& stencil)
{
  double product = 0.0, bubble = 0.0;
  for (const pd::Arm<3>& arm : stencil.half) {
    const double pull = arm.kappa * (arm.xi / arm.length).prod();
    const auto line = geom::pieces_of_line<3>(arm.step);
    for (const geom::LinePiece<3>& piece : line)
      for (const int end : {-1, 1}) {
        const double way = end < 0 ? piece.enter : piece.leave;
        if (&piece == (end < 0 ? &line.front() : &line.back())) continue;
        Vector<3> x;
        for (std::size_t d = 0; d < 3; ++d) x[static_cast<Eigen::Index>(d)] = way * arm.step[d] - piece.cell[d];
        const face_trace::Twist at = face_trace::twist(x);
        product += end * pull * at.product;
        bubble += end * pull * at.bubble;
      }
  }
  return std::abs(bubble) > 1e-3 * std::abs(product) ? -product / bubble : 0.0;
}
} // namespace pdx::couple
