#include "pdx/couple/face_trace.hpp"

#include "pdx/geom/line_pieces.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::couple {
namespace face_trace {
constexpr double kOnLine = 1e-9;  // spacings
constexpr double kNothing = 1e-9; // a weight

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

Index grid_cell(Index site, Index ratio) { return (site >= 0 ? site : site - ratio + 1) / ratio; }
bool on_line(double x) { return std::abs(x - std::round(x)) < kOnLine; }

Site<3> moved(Site<3> site, std::size_t axis, Index by)
{
  site[axis] += by;
  return site;
}

/// Lattice cells on either side of a face, the particle's first.
struct Face {
  Site<3> inner, outer;
  Face beside(std::size_t axis, Index by) const { return {moved(inner, axis, by), moved(outer, axis, by)}; }
};

/// Lattice lines that bound what a trace is averaged over; nothing: it is not.
using Zone = std::optional<std::array<Index, 2>>;

/// What nodes of one direction have of a place.
struct Trace {
  Index first = 0; ///< node
  std::vector<double> weights;

  void add(Index node, double weight)
  {
    if (weights.empty()) first = node;
    if (node < first) weights.insert(weights.begin(), static_cast<std::size_t>(first - node), 0.0);
    first = std::min(first, node);
    while (node >= first + static_cast<Index>(weights.size())) weights.push_back(0.0);
    weights[static_cast<std::size_t>(node - first)] += weight;
  }
};

/// A point of a face, as its nodes see it.
class FacePoint {
public:
  FacePoint(const SpaceShape& shape, Index zone, const Vector<3>& x, const Face& bond)
      : shape_(shape), zone_(zone), ratio_(shape.of->material.ratio), x_(x), cell_(bond.outer)
  {
    if (zone > 0) find_face(bond);
    for (std::size_t d = 0; d < 3; ++d) traces_[d] = trace(d);
    find_bubble();
  }

  bool carry(const NodeRows& rows, Host& host) const
  {
    const auto& [first, second, third] = traces_;
    for (std::size_t k = 0; k < third.weights.size(); ++k)
      for (std::size_t j = 0; j < second.weights.size(); ++j)
        for (std::size_t i = 0; i < first.weights.size(); ++i) {
          const double weight = first.weights[i] * second.weights[j] * third.weights[k] + twisted({i, j, k});
          if (std::abs(weight) < kNothing) continue;
          const auto row = rows.find({first.first + static_cast<Index>(i), second.first + static_cast<Index>(j),
                                      third.first + static_cast<Index>(k)});
          if (row == rows.end() || !host.add(row->second, weight)) return false;
        }
    return true;
  }

private:
  double at(std::size_t axis) const { return x_[static_cast<Eigen::Index>(axis)]; }
  bool parts(const Face& face) const { return shape_.parts(face.inner, face.outer); }

  /// One through whose cells the point is seen; on an edge that of the bond, if it is one.
  void find_face(const Face& bond)
  {
    for (std::size_t d = 0; d < 3 && !face_; ++d) {
      if (!on_line(at(d))) continue;
      const auto line = static_cast<Index>(std::lround(at(d)));
      for (const Index up : {0, 1}) {
        Face face{bond.inner, bond.inner};
        face.inner[d] = line - 1 + up;
        face.outer[d] = line - up;
        for (const bool beyond : {false, true}) { // seen along the bond from one cell or from the other
          if (beyond)
            for (const std::size_t e : {(d + 1) % 3, (d + 2) % 3}) face.inner[e] = face.outer[e] = bond.outer[e];
          if (face_ || !parts(face)) continue;
          face_ = face;
          across_ = d;
        }
      }
    }
  }

  /// Cells that the face goes on for from one of its cells, and whether the body ends there.
  std::pair<Index, bool> look(const Face& from, std::size_t axis, Index step) const
  {
    Index count = 0;
    while (count < 2 * zone_ && parts(from.beside(axis, (count + 1) * step))) ++count;
    const Face end = from.beside(axis, (count + 1) * step);
    const auto nothing = [&](const Site<3>& site) { return !shape_.where.active.has(site) && !shape_.of->has(site); };
    return {count, count < 2 * zone_ && nothing(end.inner) && nothing(end.outer)};
  }

  Zone zone_of(const Face& face, std::size_t axis) const
  {
    const auto [below, low] = look(face, axis, -1);
    const auto [above, high] = look(face, axis, 1);
    const Index begin = face.inner[axis] - below, end = face.inner[axis] + above + 1;
    if (low && high && end - begin < 2 * zone_) return {{begin, end}};
    if (low && below < zone_) return {{begin, std::min(begin + zone_, end)}};
    if (high && above < zone_) return {{std::max(begin, end - zone_), end}};
    return std::nullopt;
  }

  /// The mean of the hats over a zone, continued to the place by the mean slope.
  void average(const std::array<Index, 2>& zone, double place, double share, Trace& trace) const
  {
    const double begin = zone[0], end = zone[1], width = end - begin, offset = (place - 0.5 * (begin + end)) / width;
    for (Index node = grid_cell(zone[0], ratio_); (node - 1) * ratio_ < zone[1]; ++node) {
      const double peak = node * ratio_;
      const auto hat = [&](double s) { return std::max(0.0, 1.0 - std::abs(s - peak) / ratio_); };
      double mean = 0.0;
      for (const double side : {-1.0, 0.0}) {
        const double from = std::clamp(peak + side * ratio_, begin, end),
                     to = std::clamp(peak + (side + 1.0) * ratio_, begin, end);
        mean += (to - from) * hat(0.5 * (from + to)) / width;
      }
      trace.add(node, share * (mean + offset * (hat(end) - hat(begin))));
    }
  }

  void add_to(Trace& trace, std::size_t axis, const Zone& zone, double share) const
  {
    if (zone) return average(*zone, at(axis), share, trace);
    const Index low = grid_cell(cell_[axis], ratio_);
    const double t = at(axis) / ratio_ - low;
    trace.add(low, share * (1.0 - t));
    trace.add(low + 1, share * t);
  }

  Trace trace(std::size_t axis)
  {
    Trace trace;
    Zone mine, other;
    if (face_ && axis != across_) {
      mine = other = zone_of(*face_, axis);
      if (on_line(at(axis))) { // bonds that cross each other on the border of a zone share both sides
        const Face beside = face_->beside(axis, at(axis) < face_->inner[axis] + 0.5 ? -1 : 1);
        if (parts(beside)) other = zone_of(beside, axis);
      }
    }
    averaged_ = averaged_ || mine || other;
    const bool alike = mine == other;
    add_to(trace, axis, mine, alike ? 1.0 : 0.5);
    if (!alike) add_to(trace, axis, other, 0.5);
    return trace;
  }

  void find_bubble()
  {
    std::size_t lines = 0;
    for (std::size_t d = 0; d < 3; ++d)
      if (on_line(at(d))) {
        ++lines;
        across_ = d;
      }
    if (averaged_ || lines != 1) return;
    const auto middle = [&](std::size_t d) { return at(d) - std::floor(at(d)) - 0.5; };
    bubble_ = shape_.face_share / (ratio_ * ratio_) * face_bubble(middle((across_ + 1) % 3), middle((across_ + 2) % 3));
  }
  double twisted(const std::array<std::size_t, 3>& node) const
  {
    if (bubble_ == 0.0) return 0.0;
    const double sign = node[(across_ + 1) % 3] == node[(across_ + 2) % 3] ? 1.0 : -1.0;
    return sign * bubble_ * traces_[across_].weights[node[across_]];
  }

  const SpaceShape& shape_;
  Index zone_, ratio_;
  Vector<3> x_;
  Site<3> cell_; ///< whose hats are taken
  std::optional<Face> face_;
  std::size_t across_ = 0;
  std::array<Trace, 3> traces_;
  bool averaged_ = false;
  double bubble_ = 0.0;
};
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

std::optional<Host> face_host(const SpaceShape& shape, const NodeRows& rows, Index zone, const Vector<3>& x,
                              const Site<3>& inner, const Site<3>& beyond)
{
  if (!shape.has_point(beyond)) return std::nullopt;
  Host host;
  const face_trace::Face bond{inner, beyond};
  if (zone > 0 && face_trace::FacePoint(shape, zone, x, bond).carry(rows, host)) return host;
  host.clear(); // no room for all that would be averaged over
  if (!face_trace::FacePoint(shape, 0, x, bond).carry(rows, host))
    throw std::logic_error("a bond leaves through a face whose nodes have no rows");
  return host;
}
} // namespace pdx::couple
