#include "pdx/record/crack_state.hpp"

#include "pdx/geom/clip.hpp"
#include "pdx/track/crack_growth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ranges>

namespace pdx::record {
namespace {
/// What a crack has beyond an end that it was given with, from there on. Cracks keep their numbers and their points.
crack::Polyline carried_on(const crack::CrackSet& now, const crack::Tip& given)
{
  crack::Polyline points = now.points(given.crack);
  if (!given.last) std::ranges::reverse(points);
  const auto start = std::ranges::min_element(points, {}, [&](const Vector<2>& x) { return (x - given.at).norm(); });
  crack::Polyline path{given.at};
  path.insert(path.end(), start + 1, points.end());
  return path;
}

/// Two tips that met part what lies between them.
void part_way(const std::vector<double>& carried, const CrackState& before, std::vector<track::TipGrowth>& growths,
              std::span<const int> end_of)
{
  for (track::TipGrowth& a : growths) {
    if (!a.met || end_of[a.tip] < 0 || end_of[*a.met] < 0) continue;
    const auto b = std::ranges::find(growths, *a.met, &track::TipGrowth::tip);
    if (b->met && *b->met == a.tip && b->tip < a.tip) continue; // done
    const auto had = [&](std::size_t tip) {
      const auto end = static_cast<std::size_t>(end_of[tip]);
      return std::max(0.0, before.ends[end].grown - carried[end]);
    };
    const double all = track::length(a.path), of_a = had(a.tip), of_b = had(b->tip), known = of_a + of_b;
    const double mine = known < all ? of_a + 0.5 * (all - known) : all * of_a / known;
    a.path = track::path_up_to(a.path, mine);
    a.farthest_broken = mine;
    b->path = track::path_up_to(b->path, all - mine);
    b->farthest_broken = all - mine;
    b->met.reset();
  }
}
} // namespace

Vector<2> CrackEnd::at_farthest() const { return track::place_on(path, direction, farthest_broken); }
Vector<2> CrackEnd::direction_over(double length) const
{
  const double back = farthest_broken - length;
  const Vector<2> behind =
      back > 0.0 ? track::place_on(path, direction, back) : Vector<2>(given.at + back * given.direction);
  return (at_farthest() - behind).normalized();
}
double CrackEnd::angle_degrees() const { return record::angle_degrees(given, tip()); }

double angle_degrees(const crack::Tip& from, const Vector<2>& to)
{
  const Vector<2> way = to - from.at;
  const double across = from.direction.x() * way.y() - from.direction.y() * way.x();
  return std::atan2(across, from.direction.dot(way)) * 180.0 / std::numbers::pi;
}

double length_inside(const crack::CrackSet& cracks, int crack, const geom::Box<2>& body)
{
  double length = 0.0;
  const crack::Polyline& p = cracks.points(crack);
  for (std::size_t k = 0; k + 1 < p.size(); ++k)
    if (const auto part = geom::clip<2>(p[k], p[k + 1], body))
      length += (part->leave - part->enter) * (p[k + 1] - p[k]).norm();
  return length;
}

CrackState crack_state(const crack::CrackSet& given, const geom::Box<2>& body)
{
  CrackState state;
  for (const crack::Tip& tip : given.tips()) state.ends.push_back({tip, {tip.at}, tip.direction});
  for (int k = 0; k < given.size(); ++k) state.length += length_inside(given, k, body);
  return state;
}

CrackState crack_state(const scene::Discretisation& d, const CrackState& before)
{
  CrackState state;
  std::vector<double> carried; // by elements, of each end
  for (const CrackEnd& end : before.ends) {
    CrackEnd now{end.given, carried_on(d.cracks, end.given), end.given.direction};
    carried.push_back(track::length(now.path));
    now.grown = now.first_intact = now.farthest_broken = carried.back();
    state.ends.push_back(std::move(now));
  }
  for (int k = 0; k < d.cracks.size(); ++k) state.length += length_inside(d.cracks, k, d.body);
  if (!d.bonds) return state;
  std::vector<int> end_of; // of each tip; -1: of a crack that was not given
  for (const crack::Tip& tip : d.cracks.tips()) {
    const auto found = std::ranges::find_if(before.ends, [&tip](const CrackEnd& end) {
      return end.given.crack == tip.crack && end.given.last == tip.last;
    });
    end_of.push_back(found == before.ends.end() ? -1 : static_cast<int>(found - before.ends.begin()));
  }
  std::vector<track::TipGrowth> growths = track::crack_growth(d.system.rows.comm, d.bonds->parts(), d.cracks, &d.seams);
  part_way(carried, before, growths, end_of);
  for (const track::TipGrowth& growth : growths) {
    const double grown = track::length(growth.path);
    state.length += grown;
    if (end_of[growth.tip] < 0) continue;
    CrackEnd& end = state.ends[static_cast<std::size_t>(end_of[growth.tip])];
    end.path.insert(end.path.end(), growth.path.begin() + 1, growth.path.end());
    end.direction = growth.direction;
    end.grown += grown;
    end.first_intact += growth.first_intact;
    end.farthest_broken += growth.farthest_broken;
  }
  return state;
}
} // namespace pdx::record
