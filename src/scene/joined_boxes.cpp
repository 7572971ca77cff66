#include "joined_boxes.hpp"

#include "pdx/geom/box_cover.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace pdx::scene {
namespace {
constexpr std::int64_t kMargin = 64;     // sites around the body that bonds may reach [-]
constexpr double kMostNames = 1LL << 50; // bond names have 64 bits, arms and parts take 13
constexpr int kFinest = 10;              // shares of a spacing that are tried

bool same(double a, double b) { return std::abs(a - b) <= kFits * a; }

/// How far x is from the nearest whole number.
double fraction(double x) { return x - std::round(x); }

/// Spacings from one corner to another.
Vector<2> spacings(const Vector<2>& from, const Vector<2>& to, double dx) { return (to - from) / dx; }

bool one_lattice(const options::PdOptions& pd, std::size_t p, std::size_t q)
{
  const Vector<2> away = spacings(pd.patches[p].lower, pd.patches[q].lower, pd.spacing_of(p));
  return same(pd.spacing_of(p), pd.spacing_of(q)) &&
         std::max(std::abs(fraction(away[0])), std::abs(fraction(away[1]))) <=
             kFits * away.cwiseAbs().maxCoeff() + kFits;
}

void require_one_lattice(const options::SceneOptions& options, std::size_t p, std::size_t q)
{
  const options::PdOptions& pd = options.pd;
  const double dx = pd.spacing_of(p);
  const std::string which = fmt::format("-pd_patches: patches {} and {} touch or overlap", p + 1, q + 1);
  if (!same(dx, pd.spacing_of(q)))
    throw UserError(fmt::format("{} with -pd_spacing {} and {}: give them one spacing, or leave at least one row of "
                                "elements between them",
                                which, dx, pd.spacing_of(q)));
  const geom::Box<2>& other = pd.patches[q];
  const Vector<2> away = spacings(pd.patches[p].lower, other.lower, dx);
  const Vector<2> off(fraction(away[0]), fraction(away[1]));
  if (off.cwiseAbs().maxCoeff() <= kFits * away.cwiseAbs().maxCoeff() + kFits) return;
  int parts = 2; // of the spacing that lie on one lattice
  const auto fit = [&](double x) { return std::abs(fraction(parts * x)) < 1e-3; };
  while (parts <= kFinest && !(fit(off[0]) && fit(off[1]))) ++parts;
  throw UserError(fmt::format("{}, but {:.6g} by {:.6g} spacings of -pd_spacing {} lie between their corners, no whole "
                              "numbers: {}leave at least one "
                              "row of elements between them",
                              which, std::abs(away[0]), std::abs(away[1]), dx,
                              parts <= kFinest ? fmt::format("{:.10g} fits both; else ", dx / parts) : ""));
}
} // namespace

double nearest_fit(std::span<const double> sides, double dx)
{
  const double wanted = sides[0] / dx;
  const auto fits_all = [sides](double fit) {
    return std::ranges::all_of(sides, [fit](double side) {
      const double count = side / fit;
      return std::round(count) >= 1.0 && std::abs(fraction(count)) < kFits;
    });
  };
  const auto first_fit = [&](double from, double step) {
    for (double n = from, tries = 0; n >= 1.0 && n <= 2.0 * wanted && tries < 1e6; n += step, ++tries)
      if (fits_all(sides[0] / n)) return sides[0] / n;
    return 0.0;
  };
  const double coarser = first_fit(std::floor(wanted), -1.0), finer = first_fit(std::floor(wanted) + 1.0, 1.0);
  if (coarser == 0.0 || finer == 0.0) return std::max(coarser, finer);
  return coarser - dx <= (1.0 + kFits) * (dx - finer) ? coarser : finer; // as near: the cheaper
}

std::vector<std::vector<std::size_t>> patches_of_boxes(const options::SceneOptions& options)
{
  const std::vector<geom::Box<2>>& boxes = options.pd.patches;
  std::vector<std::size_t> root(boxes.size());
  std::iota(root.begin(), root.end(), 0);
  const auto body_of = [&](std::size_t p) { return geom::holder(options.points.regions, boxes[p]); };
  for (std::size_t p = 0; p < boxes.size(); ++p) (void)lattice_in<2>(boxes[p], options.pd.spacing_of(p));
  for (std::size_t p = 0; p < boxes.size(); ++p)
    for (std::size_t q = p + 1; q < boxes.size(); ++q) {
      if (body_of(p) != body_of(q)) continue;
      // Bonds that run whole from particle to particle stay in one patch, wherever that lies.
      const bool apart = !geom::touch(boxes[p], boxes[q], 1e-9 * boxes[p].size().norm());
      if (apart && (options.scheme != couple::Scheme::handshake || !one_lattice(options.pd, p, q))) continue;
      if (!apart) require_one_lattice(options, p, q);
      const std::size_t low = std::min(root[p], root[q]), high = std::max(root[p], root[q]);
      std::ranges::replace(root, high, low);
    }
  std::vector<std::vector<std::size_t>> patches;
  std::vector<std::size_t> number(boxes.size());
  for (std::size_t p = 0; p < boxes.size(); ++p) {
    if (root[p] == p) {
      number[p] = patches.size();
      patches.emplace_back();
    }
    patches[number[root[p]]].push_back(p);
  }
  return patches;
}

couple::PatchShape join_boxes(const options::SceneOptions& options, std::span<const std::size_t> entries)
{
  couple::PatchShape shape;
  const double dx = options.pd.spacing_of(entries[0]);
  for (const std::size_t p : entries) shape.boxes.push_back(options.pd.patches[p]);
  shape.box = shape.boxes[0];
  shape.body = geom::holder(options.points.regions, shape.box);
  for (const geom::Box<2>& box : shape.boxes) {
    shape.box.lower = shape.box.lower.cwiseMin(box.lower);
    shape.box.upper = shape.box.upper.cwiseMax(box.upper);
  }
  shape.lattice = lattice_in<2>(shape.box, dx);
  std::vector<geom::SiteSet<2>::Corners> sites;
  for (const geom::Box<2>& box : shape.boxes) {
    const Vector<2> lower = spacings(shape.box.lower, box.lower, shape.lattice.dx),
                    upper = spacings(shape.box.lower, box.upper, shape.lattice.dx);
    sites.push_back({{static_cast<Index>(std::round(lower[0])), static_cast<Index>(std::round(lower[1]))},
                     {static_cast<Index>(std::round(upper[0])), static_cast<Index>(std::round(upper[1]))}});
  }
  shape.active = geom::SiteSet<2>(sites);
  if (shape.active.is_box()) shape.boxes = {shape.box};
  return shape;
}

void name_sites(std::span<couple::PatchShape> shapes, geom::Box<2> body, std::span<const geom::LatticeAnchor> anchors)
{
  for (const couple::PatchShape& shape : shapes) { // layers of held particles lie outside
    body.lower = body.lower.cwiseMin(shape.box.lower);
    body.upper = body.upper.cwiseMax(shape.box.upper);
  }
  std::vector<geom::LatticeAnchor> lattices;
  const auto number = [&lattices](const geom::LatticeAnchor& of) {
    const auto known =
        std::ranges::find_if(lattices, [&of](const auto& other) { return geom::same_lattice(of, other); });
    const auto place = known - lattices.begin();
    if (known == lattices.end()) lattices.push_back(of);
    return place;
  };
  for (const geom::LatticeAnchor& anchor : anchors) (void)number(anchor);
  for (couple::PatchShape& shape : shapes) {
    const double dx = shape.lattice.dx;
    shape.names.lattice = number({shape.lattice.origin, dx});
    // The body's own corner where the lattice has it, else what of the lattice lies before it.
    std::array<std::int64_t, 2> count{};
    for (std::size_t d = 0; d < 2; ++d) {
      const auto e = static_cast<Eigen::Index>(d);
      shape.names.first[d] =
          static_cast<std::int64_t>(std::ceil((shape.lattice.origin[e] - body.lower[e]) / dx - 1e-3)) + kMargin;
      count[d] = static_cast<std::int64_t>(std::ceil(body.size()[e] / dx - 1e-3)) + 1 + 2 * kMargin;
    }
    shape.names.width = count[0];
    if (static_cast<double>(count[0]) * static_cast<double>(count[1]) * static_cast<double>(shapes.size()) > kMostNames)
      throw UserError(fmt::format("-pd_spacing is {}: a lattice as fine over the whole body, {:g} by {:g} m, has more "
                                  "sites than can be numbered",
                                  dx, body.size()[0], body.size()[1]));
  }
  for (couple::PatchShape& shape : shapes) shape.names.lattices = static_cast<std::int64_t>(lattices.size());
}
} // namespace pdx::scene
