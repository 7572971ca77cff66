#include "pdx/track/bond_graph.hpp"

#include "pdx/base/joined.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace pdx::track {
namespace {
constexpr double kOnBorder = 1e-6; // of a spacing

std::uint64_t word_of(const Site<2>& site)
{
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(site[0])) << 32 | static_cast<std::uint32_t>(site[1]);
}

/// The sites [first, second) of a window, and what is known of them row by row.
struct SiteWindow {
  SiteWindow(const geom::Lattice<2>& lattice, const geom::Box<2>& box)
  {
    for (int d = 0; d < 2; ++d) {
      const auto at = static_cast<std::size_t>(d);
      lower[at] = static_cast<Index>(std::ceil((box.lower[d] - lattice.origin[d]) / lattice.dx - 0.5 - kOnBorder));
      const double last = std::floor((box.upper[d] - lattice.origin[d]) / lattice.dx - 0.5 + kOnBorder);
      count[at] = std::max(static_cast<Index>(last) - lower[at] + 1, 0);
    }
  }
  std::size_t size() const { return static_cast<std::size_t>(count[0]) * static_cast<std::size_t>(count[1]); }
  bool holds(const Site<2>& site) const
  {
    return site[0] >= lower[0] && site[0] < lower[0] + count[0] && site[1] >= lower[1] && site[1] < lower[1] + count[1];
  }
  std::size_t number(const Site<2>& site) const
  {
    return static_cast<std::size_t>(site[1] - lower[1]) * static_cast<std::size_t>(count[0]) +
           static_cast<std::size_t>(site[0] - lower[0]);
  }
  Site<2> site(std::size_t number) const
  {
    const auto row = static_cast<std::size_t>(count[0]);
    return {lower[0] + static_cast<Index>(number % row), lower[1] + static_cast<Index>(number / row)};
  }
  Site<2> lower{}, count{};
};

/// What a body is made of, as the sides see it.
struct Sided {
  int particles = 0;
  bool near = true;          // none is farther than the slack and a spacing from a line
  std::map<int, int> sure;   // particles on each side, those that may not lie wrong
  std::map<int, int> unsure; // the others
};
} // namespace

BondGraph::BondGraph(const geom::Lattice<2>& lattice, const pd::Stencil<2>& stencil,
                     std::function<bool(const Site<2>&)> has)
    : lattice_(lattice), stencil_(stencil), has_(std::move(has))
{
  for (const pd::Arm<2>& arm : stencil_.half) lines_.push_back(geom::pieces_of_line<2>(arm.step));
}

void BondGraph::add(const Site<2>& site, const std::array<std::uint64_t, 2>& gone)
{
  std::array<std::uint64_t, 2>& words = gone_[word_of(site)];
  for (std::size_t w = 0; w < 2; ++w) words[w] |= gone[w];
}

Site<2> BondGraph::end_of(const Site<2>& site, std::size_t arm) const
{
  const Site<2>& step = stencil_.half[arm].step;
  return {site[0] + step[0], site[1] + step[1]};
}

bool BondGraph::begins(const Site<2>& site, std::size_t arm) const
{
  return std::ranges::all_of(lines_[arm],
                             [&](const geom::LinePiece<2>& piece) { return has_(geom::cell_at<2>(site, piece)); });
}

bool BondGraph::gone(const Site<2>& site, std::size_t arm) const
{
  const auto found = gone_.find(word_of(site));
  return found != gone_.end() && (found->second[arm / 64] >> (arm % 64) & 1);
}

Bodies bodies_in(const BondGraph& graph, const geom::Box<2>& window)
{
  const SiteWindow all(graph.lattice(), window);
  Joined roots(all.size());
  Bodies bodies;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Site<2> site = all.site(k);
    if (!graph.has(site)) continue;
    bodies.sites.push_back(site);
    for (std::size_t h = 0; h < graph.stencil().half.size(); ++h) {
      const Site<2> end = graph.end_of(site, h);
      if (all.holds(end) && graph.intact(site, h)) roots.join(k, all.number(end));
    }
  }
  std::vector<int> number(all.size(), -1);
  for (const Site<2>& site : bodies.sites) {
    int& body = number[roots.root(all.number(site))];
    if (body < 0) body = bodies.count++;
    bodies.body.push_back(body);
  }
  return bodies;
}

bool are_sides(const Bodies& bodies, const BondGraph& graph, const std::function<int(const Vector<2>&)>& side_of,
               const std::function<double(const Vector<2>&)>& distance_of, double slack)
{
  std::vector<Sided> all(static_cast<std::size_t>(bodies.count));
  for (std::size_t k = 0; k < bodies.sites.size(); ++k) {
    const Vector<2> x = graph.point(bodies.sites[k]);
    const double distance = distance_of(x);
    Sided& body = all[static_cast<std::size_t>(bodies.body[k])];
    ++body.particles;
    body.near = body.near && distance < slack + graph.lattice().dx;
    ++(distance < slack ? body.unsure : body.sure)[side_of(x)];
  }
  std::map<int, int> bodies_on; // by side
  for (const Sided& body : all) {
    if (body.particles == 0 || (body.particles <= kCrumbs && body.near)) continue;
    if (body.sure.size() > 1) return false;
    const auto& votes = body.sure.empty() ? body.unsure : body.sure;
    const auto more = [](const auto& a, const auto& b) { return a.second < b.second; };
    if (++bodies_on[std::ranges::max_element(votes, more)->first] > 1) return false;
  }
  return true;
}
} // namespace pdx::track
