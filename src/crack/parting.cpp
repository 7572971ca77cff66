#include "parting.hpp"

#include "pdx/geom/orientation.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::crack {
using geom::orientation;
namespace {
/// Orders points of the line through a and b from a to b, by comparison of coordinates only.
class AlongBond {
public:
  AlongBond(const Vector<2>& a, const Vector<2>& b)
      : axis_(std::abs(b.x() - a.x()) >= std::abs(b.y() - a.y()) ? 0 : 1), sign_(b[axis_] > a[axis_] ? 1.0 : -1.0),
        from_(place(a)), to_(place(b))
  {}
  double place(const Vector<2>& x) const { return sign_ * x[axis_]; }
  bool holds(const Vector<2>& x) const { return place(x) >= from_ && place(x) <= to_; }
  double from() const { return from_; }
  double to() const { return to_; }

private:
  Eigen::Index axis_;
  double sign_, from_, to_;
};

/// Points first..last of the chain lie on the line through the bond; their neighbours do not.
struct Stretch {
  std::size_t first, last;
};

/// Does the bond change sides where it shares the stretch with the chain? Ends on the chain are left of it.
bool parts_on(const Polyline& chain, Stretch stretch, const Vector<2>& a, const Vector<2>& b)
{
  const AlongBond along(a, b);
  std::size_t enter = stretch.first, leave = stretch.last;
  if (along.place(chain[enter]) > along.place(chain[leave])) std::swap(enter, leave);
  if (along.place(chain[leave]) < along.from() || along.place(chain[enter]) > along.to()) return false;
  for (const std::size_t end : {std::size_t{0}, chain.size() - 1})
    if (end >= stretch.first && end <= stretch.last && along.holds(chain[end])) return false;
  const auto left = [&chain](std::size_t k, const Vector<2>& x) {
    return left_at(chain[k - 1], chain[k], chain[k + 1], x);
  };
  const bool before = along.place(chain[enter]) <= along.from() || left(enter, a);
  const bool after = along.place(chain[leave]) >= along.to() || left(leave, b);
  return before != after;
}
} // namespace

bool left_at(const Vector<2>& prev, const Vector<2>& v, const Vector<2>& next, const Vector<2>& x)
{
  const bool of_first = orientation(prev, v, x) >= 0, of_second = orientation(v, next, x) >= 0;
  return orientation(prev, v, next) >= 0 ? of_first && of_second : of_first || of_second;
}

bool parts(const Polyline& chain, const Vector<2>& a, const Vector<2>& b)
{
  if (a == b) return false;
  int before = orientation(a, b, chain[0]);
  for (std::size_t k = 0; k + 1 < chain.size();) {
    if (before == 0) { // points k.. of the chain are on the line of the bond
      Stretch stretch{k, k};
      while (stretch.last + 1 < chain.size() && (before = orientation(a, b, chain[stretch.last + 1])) == 0)
        ++stretch.last;
      if (parts_on(chain, stretch, a, b)) return true;
      k = stretch.last + 1;
      continue;
    }
    const int after = orientation(a, b, chain[k + 1]);
    if (before * after < 0 &&
        (orientation(chain[k], chain[k + 1], a) >= 0) != (orientation(chain[k], chain[k + 1], b) >= 0))
      return true;
    before = after;
    ++k;
  }
  return false;
}

bool meet(const Vector<2>& a, const Vector<2>& b, const Vector<2>& p, const Vector<2>& q)
{
  const int of_p = orientation(a, b, p), of_q = orientation(a, b, q);
  const int of_a = orientation(p, q, a), of_b = orientation(p, q, b);
  if (of_p * of_q > 0 || of_a * of_b > 0) return false;
  if (of_p != 0 || of_q != 0) return true;
  return (a.cwiseMin(b).array() <= p.cwiseMax(q).array()).all() &&
         (p.cwiseMin(q).array() <= a.cwiseMax(b).array()).all();
}
} // namespace pdx::crack
