#include "pdx/track/crack_growth.hpp"

#include "crack_blocks.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/track/follow.hpp"

#include <algorithm>
#include <limits>

namespace pdx::track {
namespace {
constexpr double kRound = 1e-6; // of a spacing
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Height above a tip's prolongation, left of it positive.
double height(const crack::Tip& tip, const Vector<2>& x)
{
  const Vector<2> from = x - tip.at;
  return tip.direction.x() * from.y() - tip.direction.y() * from.x();
}

/// Where the line from a to b crosses the prolongation, as distance from the tip; none if it does not, or behind the
/// tip. A crossing at the tip itself counts, whatever rounding says.
std::optional<double> crossing(const crack::Tip& tip, const Vector<2>& a, const Vector<2>& b, double rounding)
{
  const auto snapped = [&](double h) { return std::abs(h) <= rounding ? 0.0 : h; };
  const double at_a = snapped(height(tip, a)), at_b = snapped(height(tip, b));
  if ((at_a >= 0.0) == (at_b >= 0.0)) return std::nullopt;
  const double share = at_a / (at_a - at_b);
  const double distance = tip.direction.dot(a - tip.at + share * (b - a));
  if (distance < -rounding) return std::nullopt;
  return std::max(0.0, distance);
}

/// The patch that holds the point.
std::optional<std::size_t> patch_of(std::span<const std::unique_ptr<pd::LatticePart<2>>> parts, const Vector<2>& x)
{
  for (std::size_t p = 0; p < parts.size(); ++p)
    if (geom::covers(parts[p]->where(), x, kRound * parts[p]->lattice().dx)) return p;
  return std::nullopt;
}

/// How far ahead of a tip growth can be its own: up to half way to a tip of another crack that faces it, and up to
/// where another crack crosses its prolongation.
double way_ahead(const crack::CrackSet& cracks, const crack::Tip& tip, double reach)
{
  double way = kFar;
  for (const crack::Tip& other : cracks.tips()) {
    const double ahead = tip.direction.dot(other.at - tip.at);
    const bool same = other.crack == tip.crack && other.last == tip.last;
    if (same || ahead <= 0.0 || std::abs(height(tip, other.at)) > reach) continue;
    way = std::min(way, other.direction.dot(tip.direction) < 0.0 ? 0.5 * ahead : ahead);
  }
  for (int c = 0; c < cracks.size(); ++c) {
    const crack::Polyline& points = cracks.points(c);
    for (std::size_t k = 0; k + 1 < points.size(); ++k)
      if (const auto crossed = crossing(tip, points[k], points[k + 1], 0.0); crossed && *crossed > reach)
        way = std::min(way, *crossed);
  }
  return way;
}

/// A particle that lost bonds.
struct LossRecord {
  std::array<Index, 2> site;
  std::array<std::uint64_t, 2> gone;
};

/// What bonds of one patch say of its cracks, alike on every rank.
class PatchGrowth {
public:
  PatchGrowth(MPI_Comm comm, const pd::LatticePart<2>& part, const crack::CrackSet& cracks,
              const crack::CrackSet* seams)
      : part_(part), cracks_(cracks), seams_(seams),
        graph_(part.lattice(), part.stencil(), [&part](const Site<2>& site) { return part.active().has(site); })
  {
    std::vector<LossRecord> mine;
    for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k) {
      const Site<2> site = part.site(part.sites()[static_cast<std::size_t>(k)]);
      const auto gone = without_seams(site, part.gone_of(k));
      if (gone[0] != 0 || gone[1] != 0) mine.push_back({{site[0], site[1]}, gone});
    }
    std::vector<Site<2>> damaged;
    for (const auto& [site, gone] : gather_all(comm, mine)) {
      damaged.push_back({site[0], site[1]});
      graph_.add(damaged.back(), gone);
    }
    blocks_ = crack_blocks(graph_, damaged);
  }

  TipGrowth grown(std::size_t tip, std::size_t patch) const
  {
    const crack::Tip& from = cracks_.tips()[tip];
    TipGrowth growth{tip, patch, {from.at}, from.direction, kFar, 0.0, std::nullopt};
    const Followed found = follow(graph_, blocks_, from.at, from.direction);
    for (const Crossing& crossing : found.crossings) growth.path.push_back(crossing.out);
    growth.path.insert(growth.path.end(), found.beyond.begin(), found.beyond.end());
    if (growth.path.size() > 1) growth.direction = found.direction;
    return growth;
  }

  /// Finds the nearest intact and the farthest broken bond along the path. If none broke there is no path.
  void look(TipGrowth& growth) const
  {
    const crack::Tip& tip = cracks_.tips()[growth.tip];
    look_along(growth);
    if (growth.farthest_broken > 0.0 || growth.path.size() == 1) return;
    growth.path = {tip.at};
    growth.direction = tip.direction;
    growth.first_intact = kFar;
    look_along(growth);
  }

private:
  void look_along(TipGrowth& growth) const
  {
    crack::Tip piece = cracks_.tips()[growth.tip];
    double before = 0.0;
    for (std::size_t k = 0; k + 1 < growth.path.size(); ++k) {
      const Vector<2> way = growth.path[k + 1] - growth.path[k];
      piece.at = growth.path[k];
      piece.direction = way.normalized();
      look_beside(growth, piece, way.norm(), before);
      before += way.norm();
    }
    piece.at = growth.path.back();
    piece.direction = growth.direction;
    look_beside(growth, piece, way_ahead(cracks_, piece, reach()), before);
  }

  double rounding() const { return kRound * part_.lattice().dx; }
  double reach() const { return (part_.stencil().reach + 1) * 1.5 * part_.lattice().dx; }

  bool is_seam(const Vector<2>& a, const Vector<2>& b) const { return seams_ && seams_->cuts(a, b); }

  std::array<std::uint64_t, 2> without_seams(const Site<2>& site, std::array<std::uint64_t, 2> gone) const
  {
    if (!seams_ || !seams_->near(graph_.point(site), part_.stencil().horizon)) return gone;
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h)
      if (gone[h / 64] >> h % 64 & 1u && is_seam(graph_.point(site), graph_.point(graph_.end_of(site, h))))
        gone[h / 64] &= ~(std::uint64_t{1} << h % 64);
    return gone;
  }

  /// Bonds that cross a straight piece, at most as far along it as its length. @param before of the path [m]
  void look_beside(TipGrowth& growth, const crack::Tip& piece, double length, double before) const
  {
    const geom::Lattice<2>& lattice = part_.lattice();
    const auto& arms = part_.stencil().half;
    const Site<2>&first = part_.active().lower(), &end = part_.active().upper();
    const Vector<2> far = piece.at + std::min(length, far_corner(piece.at)) * piece.direction;
    const auto site_of = [&](const Vector<2>& x, double more, int d) {
      return std::clamp(static_cast<Index>(std::floor((x[d] - lattice.origin[d] + more) / lattice.dx)),
                        first[static_cast<std::size_t>(d)] - 1, end[static_cast<std::size_t>(d)]);
    };
    const Vector<2> lower = piece.at.cwiseMin(far), upper = piece.at.cwiseMax(far);
    for (Index j = site_of(lower, -reach(), 1); j <= site_of(upper, reach(), 1); ++j)
      for (Index i = site_of(lower, -reach(), 0); i <= site_of(upper, reach(), 0); ++i) {
        const Site<2> site{i, j};
        const Vector<2> a = lattice.point(site);
        if (!graph_.has(site) || std::abs(height(piece, a)) > reach()) continue;
        for (std::size_t h = 0; h < arms.size(); ++h) {
          const Vector<2> b = lattice.point(graph_.end_of(site, h));
          const std::optional<double> distance = crossing(piece, a, b, rounding());
          if (!distance || *distance > length + rounding() || !graph_.begins(site, h)) continue;
          if (!graph_.gone(site, h)) {
            if (!is_seam(a, b)) growth.first_intact = std::min(growth.first_intact, before + *distance);
          } else if (before + *distance > growth.farthest_broken && !cracks_.cuts(a, b))
            growth.farthest_broken = before + *distance;
        }
      }
  }
  /// No particle is farther from a point than that [m].
  double far_corner(const Vector<2>& x) const
  {
    const geom::Lattice<2>& lattice = part_.lattice();
    const Vector<2> lower = lattice.point(part_.active().lower()), upper = lattice.point(part_.active().upper());
    return (x - lower).cwiseAbs().cwiseMax((x - upper).cwiseAbs()).norm();
  }

  const pd::LatticePart<2>& part_;
  const crack::CrackSet& cracks_;
  const crack::CrackSet* seams_;
  BondGraph graph_;
  std::vector<geom::Box<2>> blocks_;
};

/// Where along a path it first meets a chain of points, beyond a distance.
std::optional<double> meets(const crack::Polyline& path, std::span<const Vector<2>> chain, double beyond)
{
  double before = 0.0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Vector<2> way = path[k + 1] - path[k];
    const crack::Tip piece{0, true, path[k], way.normalized()};
    double first = kFar;
    for (std::size_t c = 0; c + 1 < chain.size(); ++c) {
      const auto at = crossing(piece, chain[c], chain[c + 1], 0.0);
      if (at && *at <= way.norm() && before + *at > beyond) first = std::min(first, before + *at);
    }
    if (first < kFar) return first;
    before += way.norm();
  }
  return std::nullopt;
}

/// Does a path come to a point, to a spacing and a half? How far it is there.
std::optional<double> comes_to(const crack::Polyline& path, const Vector<2>& x, double dx)
{
  double before = 0.0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Vector<2> way = path[k + 1] - path[k];
    const double along = std::clamp((x - path[k]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    if ((path[k] + along * way - x).norm() <= 1.5 * dx) return before + along * way.norm();
    before += way.norm();
  }
  return std::nullopt;
}

/// Paths end at other cracks, and at the end of one that grew towards them.
void end_at_others(std::vector<TipGrowth>& all, const crack::CrackSet& cracks,
                   std::span<const std::unique_ptr<pd::LatticePart<2>>> parts)
{
  const std::vector<TipGrowth> whole = all;
  for (std::size_t g = 0; g < all.size(); ++g) {
    const crack::Tip& tip = cracks.tips()[whole[g].tip];
    const pd::Stencil<2>& stencil = parts[whole[g].patch]->stencil();
    double end = length(whole[g].path);
    for (int c = 0; c < cracks.size(); ++c)
      if (c != tip.crack)
        if (const auto at = meets(whole[g].path, cracks.points(c), 0.0)) end = std::min(end, *at);
    for (const TipGrowth& other : whole) {
      if (other.tip == whole[g].tip || other.patch != whole[g].patch) continue;
      const crack::Polyline flank = path_up_to(other.path, length(other.path) - stencil.horizon);
      const auto at_end = comes_to(whole[g].path, other.path.front(), stencil.dx);
      if (at_end && *at_end <= end) {
        end = *at_end;
        all[g].met = other.tip;
      } else if (const auto at =
                     comes_to(other.path, tip.at, stencil.dx) ? std::nullopt : meets(whole[g].path, flank, 0.0))
        end = std::min(end, *at);
    }
    if (end >= length(whole[g].path)) continue;
    all[g].path = path_up_to(whole[g].path, end);
    all[g].farthest_broken = std::min(all[g].farthest_broken, end);
  }
}
} // namespace

double length(const crack::Polyline& path)
{
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) sum += (path[k + 1] - path[k]).norm();
  return sum;
}

Vector<2> place_on(const crack::Polyline& path, const Vector<2>& direction, double distance)
{
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const double way = (path[k + 1] - path[k]).norm();
    if (distance <= way) return path[k] + distance / way * (path[k + 1] - path[k]);
    distance -= way;
  }
  return path.back() + distance * direction;
}

crack::Polyline path_up_to(const crack::Polyline& path, double distance)
{
  crack::Polyline part{path.front()};
  for (std::size_t k = 0; k + 1 < path.size() && distance > 0.0; ++k) {
    const double way = (path[k + 1] - path[k]).norm();
    part.push_back(distance >= way ? path[k + 1] : Vector<2>(path[k] + distance / way * (path[k + 1] - path[k])));
    distance -= way;
  }
  return part;
}

std::vector<TipGrowth> crack_growth(MPI_Comm comm, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                    const crack::CrackSet& cracks, const crack::CrackSet* seams)
{
  std::vector<std::vector<std::size_t>> tips(parts.size()); // by patch
  for (std::size_t t = 0; t < cracks.tips().size(); ++t)
    if (const auto patch = patch_of(parts, cracks.tips()[t].at)) tips[*patch].push_back(t);
  std::vector<TipGrowth> all;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (tips[p].empty()) continue;
    const PatchGrowth patch(comm, *parts[p], cracks, seams);
    for (const std::size_t t : tips[p]) {
      all.push_back(patch.grown(t, p));
      patch.look(all.back());
    }
  }
  std::ranges::sort(all, {}, &TipGrowth::tip);
  end_at_others(all, cracks, parts);
  return all;
}
} // namespace pdx::track
