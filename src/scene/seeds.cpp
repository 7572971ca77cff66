#include "pdx/scene/seeds.hpp"
#include "pdx/options/adapt_options.hpp"

#include "pdx/adapt/seed_box.hpp"
#include "pdx/geom/box_cover.hpp"
#include "pdx/mesh/cells_near.hpp"
#include "pdx/scene/model.hpp"

#include "joined_boxes.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::scene {
namespace {
constexpr double kAtTip = 1e-6;  // of the smallest element at a tip: what is as near to an edge is on it
constexpr double kInside = 1e-6; // of a turn

/// The tip of a crack and the elements that hold it.
struct SeedTip {
  crack::Tip tip;
  std::vector<adapt::Corners> own;
  double shortest = std::numeric_limits<double>::infinity(); // side of them [m]
  std::string place;                                         // for messages
};

geom::Box<2> square(const Vector<2>& middle, double half_width)
{
  return {middle.array() - half_width, middle.array() + half_width};
}

double shortest_side(std::span<const adapt::Corners> elements)
{
  double least = std::numeric_limits<double>::infinity();
  for (const adapt::Corners& x : elements)
    for (std::size_t k = 0; k < 4; ++k) least = std::min(least, (x[(k + 1) % 4] - x[k]).norm());
  return least;
}

/// Those of cracks that end between elements, not on a border that only the mesh knows.
std::vector<SeedTip> tips_inside(MPI_Comm comm, const options::SceneOptions& options)
{
  std::vector<SeedTip> inside;
  const crack::CrackSet cracks = cracks_in(options, options.mesh.box);
  for (const crack::Tip& tip : cracks.tips()) {
    SeedTip seed{tip, {}, 0.0, fmt::format("the tip {} of crack {}", options.frame.text(tip.at), tip.crack + 1)};
    const auto near = mesh::cells_near(comm, options.mesh, square(tip.at, 0.0));
    double turn = 0.0;
    for (const adapt::Corners& element : near) {
      const double share = adapt::share_of_turn(element, tip.at, kAtTip * shortest_side(near));
      turn += share;
      if (share > 0.0) seed.own.push_back(element);
    }
    if (turn < 1.0 - kInside) continue;
    seed.shortest = shortest_side(seed.own);
    inside.push_back(std::move(seed));
  }
  if (inside.empty())
    throw UserError("-adapt_seed tip: no crack ends inside the body: give one that does, or -pd_patches");
  return inside;
}

/// Width and height of the elements at a tip, one after the other [m].
std::vector<double> sides_at(const SeedTip& seed)
{
  std::vector<double> sides;
  for (const adapt::Corners& element : seed.own) {
    if (!adapt::is_box(element, adapt::kFits * seed.shortest))
      throw UserError(fmt::format("-adapt_seed tip: at {} an element is no box along the axes, which particles need: "
                                  "change the mesh there, or give -pd_patches",
                                  seed.place));
    const Vector<2> size = adapt::box_around(element).size();
    sides.insert(sides.end(), {size[0], size[1]});
  }
  return sides;
}

bool divides(double dx, double side)
{
  const double count = side / dx;
  return std::round(count) >= 1.0 && std::abs(count - std::round(count)) <= kFits * std::max(1.0, count);
}

void require_spacing(const SeedTip& seed, double dx)
{
  const std::vector<double> sides = sides_at(seed);
  for (std::size_t k = 0; k < sides.size(); k += 2) {
    if (divides(dx, sides[k]) && divides(dx, sides[k + 1])) continue;
    const double fit = nearest_fit(sides, dx);
    throw UserError(fmt::format(
        "-pd_spacing is {}: the sides {:.6g} and {:.6g} m of an element at {} must be whole numbers of it; {}", dx,
        sides[k], sides[k + 1], seed.place,
        fit > 0.0 ? fmt::format("the nearest that fits is {:.10g}", fit) : "none near fits: change the mesh"));
  }
  for (const adapt::Corners& element : seed.own) (void)lattice_in<2>(adapt::box_around(element), dx); // not too many
}

/// The spacing nearest to a quarter of the smallest element that divides those at all tips [m].
double chosen_spacing(const std::vector<SeedTip>& seeds)
{
  double shortest = std::numeric_limits<double>::infinity();
  std::vector<double> all;
  for (const SeedTip& seed : seeds) {
    const std::vector<double> sides = sides_at(seed);
    all.insert(all.end(), sides.begin(), sides.end());
    shortest = std::min(shortest, seed.shortest);
  }
  std::ranges::sort(all);
  const double dx = nearest_fit(all, options::kSeedShare * shortest);
  if (dx > 0.0) return dx;
  const auto [low, high] = std::ranges::minmax(all);
  throw UserError(fmt::format("-pd_spacing is missing: no spacing near {:.6g} m divides all elements at the tips of "
                              "cracks, whose sides are {:.6g} to {:.6g} m: give one that does, or make them square",
                              options::kSeedShare * shortest, low, high));
}

geom::Box<2> box_at(MPI_Comm comm, const options::SceneOptions& options, const SeedTip& seed, double dx)
{
  const double reach = options::expansion_length(options, options.pd.horizon_ratio * dx, seed.shortest);
  const auto around = mesh::cells_near(comm, options.mesh, square(seed.tip.at, reach));
  if (const auto box = adapt::seed_box(seed.own, around, seed.tip.at, dx, reach)) return *box;
  throw UserError(fmt::format("-adapt_seed tip: the elements at {} do not lie on one lattice of -pd_spacing {}: change "
                              "the mesh there, or give -pd_patches",
                              seed.place, dx));
}

/// The same ground without any of it twice.
std::vector<geom::Box<2>> apart(const std::vector<geom::Box<2>>& boxes, double near)
{
  std::vector<geom::Box<2>> all;
  for (const geom::Box<2>& box : boxes) {
    std::vector<geom::Box<2>> left{box};
    for (const geom::Box<2>& earlier : all) {
      std::vector<geom::Box<2>> rest;
      for (const geom::Box<2>& piece : left)
        std::ranges::copy(geom::without(piece, earlier, near), std::back_inserter(rest));
      left = std::move(rest);
    }
    all.insert(all.end(), left.begin(), left.end());
  }
  return geom::joined(std::move(all), near);
}
} // namespace

void plant_seeds(MPI_Comm comm, options::SceneOptions& options)
{
  const std::vector<SeedTip> seeds = tips_inside(comm, options);
  options::PdOptions& pd = options.pd;
  const bool chosen = pd.spacing.empty();
  if (chosen) pd.spacing = {chosen_spacing(seeds)};
  const double dx = pd.spacing[0];
  std::vector<geom::Box<2>> boxes;
  for (const SeedTip& seed : seeds) {
    require_spacing(seed, dx);
    boxes.push_back(box_at(comm, options, seed, dx));
  }
  pd.patches = apart(boxes, adapt::kFits * dx);
  std::string text;
  for (const std::array<double, 4>& box : given_boxes(options))
    text += fmt::format("{}{:.10g}", text.empty() ? "" : ",", fmt::join(box, ","));
  options.notes.push_back(fmt::format("-adapt_seed tip: -pd_patches {} -pd_spacing {:.10g}{}", text, dx,
                                      chosen ? ", chosen near a quarter of the elements there" : ""));
}

std::vector<std::array<double, 4>> given_boxes(const options::SceneOptions& options)
{
  std::vector<std::array<double, 4>> boxes;
  for (const geom::Box<2>& patch : options.pd.patches) {
    const Vector<2> lower = options.frame.given<2>(patch.lower), upper = options.frame.given<2>(patch.upper);
    boxes.push_back({lower[0], lower[1], upper[0], upper[1]});
  }
  return boxes;
}
} // namespace pdx::scene
