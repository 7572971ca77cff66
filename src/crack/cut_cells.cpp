#include "pdx/crack/cut_cells.hpp"

#include "pdx/base/error.hpp"
#include "pdx/geom/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pdx::crack {
namespace {
constexpr double kRounding = 1e-12; // of the length of an edge

void sort_unique(std::vector<Index>& numbers)
{
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// One crack over one mesh.
class Search {
public:
  Search(const CrackSet& cracks, int crack, const CellView& mesh, double tolerance)
      : cracks_(cracks), crack_(crack), mesh_(mesh), tolerance_(tolerance)
  {}
  double point_distance(const Vector<2>& x) const
  {
    const double d = cracks_.signed_distance(crack_, x);
    return std::abs(d) <= tolerance_ ? tolerance_ : d;
  }
  CutCell judge(Index number, const std::vector<double>& distance) const
  {
    const auto& corners = mesh_.cells[static_cast<std::size_t>(number)];
    CutCell cut{number, CellKind::whole, 0};
    int crossed = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const Index a = corners[k], b = corners[(k + 1) % 4];
      if ((distance[static_cast<std::size_t>(a)] > 0.0) == (distance[static_cast<std::size_t>(b)] > 0.0)) continue;
      if (!reaches(point(a), point(b))) continue;
      cut.edges = static_cast<std::uint8_t>(cut.edges | 1u << k);
      ++crossed;
    }
    if (crossed > 1)
      cut.kind = CellKind::through;
    else if (crossed == 1 || holds_tip(corners))
      cut.kind = CellKind::tip;
    return cut;
  }

private:
  const Vector<2>& point(Index number) const { return mesh_.points[static_cast<std::size_t>(number)]; }

  /// Of an edge whose ends are on different sides: is it the crack that parts them, not its prolongation?
  bool reaches(const Vector<2>& a, const Vector<2>& b) const
  {
    const bool ordered = std::pair(a.x(), a.y()) < std::pair(b.x(), b.y()); // alike in both cells and on every rank
    const Vector<2> at = ordered ? crossing(a, b) : crossing(b, a);
    const double slack = tolerance_ + kRounding * (b - a).norm();
    return std::abs(cracks_.signed_distance(crack_, at)) <= slack && cracks_.beyond(crack_, at) <= slack;
  }
  /// Where the edge changes sides: at an end that the crack passes within the tolerance, else in between.
  Vector<2> crossing(Vector<2> a, Vector<2> b) const
  {
    for (const Vector<2>& end : {a, b})
      if (std::abs(cracks_.signed_distance(crack_, end)) <= tolerance_) return end;
    const int side = cracks_.side(crack_, a);
    for (int halving = 0; halving < 60; ++halving) {
      const Vector<2> middle = 0.5 * (a + b);
      (cracks_.side(crack_, middle) == side ? a : b) = middle;
    }
    return b;
  }
  /// Strictly inside, as a tip on an edge is seen by the edges.
  bool holds_tip(const std::array<Index, 4>& corners) const
  {
    return std::any_of(cracks_.tips().begin(), cracks_.tips().end(), [&](const Tip& tip) {
      if (tip.crack != crack_) return false;
      for (std::size_t k = 0; k < 4; ++k)
        if (geom::orientation(point(corners[k]), point(corners[(k + 1) % 4]), tip.at) <= 0) return false;
      return true;
    });
  }

  const CrackSet& cracks_;
  int crack_;
  const CellView& mesh_;
  double tolerance_;
};
} // namespace

Cuts find_cuts(const CrackSet& cracks, int crack, const CellView& mesh, double tolerance)
{
  PDX_ASSERT(tolerance > 0.0);
  const Search search(cracks, crack, mesh, tolerance);
  Cuts cuts;
  for (const Vector<2>& x : mesh.points) cuts.distance.push_back(search.point_distance(x));
  for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
    const CutCell cut = search.judge(static_cast<Index>(c), cuts.distance);
    if (cut.kind == CellKind::whole) continue;
    cuts.cells.push_back(cut);
    const auto& corners = mesh.cells[c];
    if (cut.kind == CellKind::through) cuts.points.insert(cuts.points.end(), corners.begin(), corners.end());
    for (std::size_t k = 0; k < 4; ++k)
      if (cut.kind == CellKind::tip && cut.edges >> k & 1u)
        cuts.closing.insert(cuts.closing.end(), {corners[k], corners[(k + 1) % 4]});
  }
  sort_unique(cuts.points);
  sort_unique(cuts.closing);
  return cuts;
}
} // namespace pdx::crack
