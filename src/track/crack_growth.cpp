#include "pdx/track/crack_growth.hpp"

#include <algorithm>
#include <limits>
#include <optional>

namespace pdx::track {
namespace {
constexpr double kRound = 1e-6; // of a spacing

/// Height above the tip's prolongation, left of it positive.
double height(const crack::Tip& tip, const Vector<2>& x)
{
  const Vector<2> from = x - tip.at;
  return tip.direction.x() * from.y() - tip.direction.y() * from.x();
}

/// Where the bond from a to b crosses the prolongation, as distance from the tip; none if it does not, or behind the
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
  double way = std::numeric_limits<double>::infinity();
  for (const crack::Tip& other : cracks.tips()) {
    const double ahead = tip.direction.dot(other.at - tip.at);
    if (&other == &tip || ahead <= 0.0 || std::abs(height(tip, other.at)) > reach) continue;
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

/// What this rank's particles know: bonds that start at them.
void look(const pd::LatticePart<2>& part, const crack::CrackSet& cracks, const crack::CrackSet* seams,
          TipGrowth& growth)
{
  const crack::Tip& tip = cracks.tips()[growth.tip];
  const geom::Lattice<2>& lattice = part.lattice();
  const auto& arms = part.stencil().half;
  const double rounding = kRound * lattice.dx, reach = (part.stencil().reach + 1) * 1.5 * lattice.dx;
  const double way = way_ahead(cracks, tip, reach);
  std::vector<std::uint8_t> intact(arms.size());
  for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k) {
    const Site<2> site = part.site(part.sites()[static_cast<std::size_t>(k)]);
    const Vector<2> a = lattice.point(site);
    if (std::abs(height(tip, a)) > reach) continue;
    std::ranges::fill(intact, std::uint8_t{0});
    part.for_each_bond(k, [&](std::size_t h, int sign, const Site<2>&, double) {
      if (sign > 0) intact[h] = 1;
    });
    for (std::size_t h = 0; h < arms.size(); ++h) {
      const Site<2> other{site[0] + arms[h].step[0], site[1] + arms[h].step[1]};
      if (!part.begins(site, h)) continue;
      const Vector<2> b = lattice.point(other);
      const std::optional<double> distance = crossing(tip, a, b, rounding);
      if (!distance || *distance > way + rounding) continue;
      if (intact[h])
        growth.first_intact = std::min(growth.first_intact, *distance);
      else if (*distance > growth.farthest_broken && !cracks.cuts(a, b) && !(seams && seams->cuts(a, b)))
        growth.farthest_broken = *distance;
    }
  }
}
} // namespace

std::vector<TipGrowth> crack_growth(MPI_Comm comm, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                    const crack::CrackSet& cracks, const crack::CrackSet* seams)
{
  std::vector<TipGrowth> all;
  std::vector<double> nearest; // first_intact and -farthest_broken, for one minimum over ranks
  for (std::size_t t = 0; t < cracks.tips().size(); ++t) {
    const std::optional<std::size_t> patch = patch_of(parts, cracks.tips()[t].at);
    if (!patch) continue;
    TipGrowth growth{t, *patch, std::numeric_limits<double>::infinity(), 0.0};
    look(*parts[*patch], cracks, seams, growth);
    nearest.insert(nearest.end(), {growth.first_intact, -growth.farthest_broken});
    all.push_back(growth);
  }
  MPI_Allreduce(MPI_IN_PLACE, nearest.data(), static_cast<int>(nearest.size()), MPI_DOUBLE, MPI_MIN, comm);
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].first_intact = nearest[2 * k];
    all[k].farthest_broken = -nearest[2 * k + 1];
  }
  return all;
}
} // namespace pdx::track
