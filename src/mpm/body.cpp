#include "pdx/mpm/body.hpp"

#include "pdx/base/error.hpp"

#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::mpm {
namespace {
constexpr double kWhole = 1e-6; // of a cell: a grid that reaches as near is wide enough
constexpr double kMostCells = std::numeric_limits<Index>::max() / 8.0; // cells, edges and vertices share one numbering

template <int Dim> Site<Dim> site_in_cell(int site, int ratio)
{
  Site<Dim> at{};
  for (std::size_t d = 0; d < Dim; ++d) {
    at[d] = site % ratio;
    site /= ratio;
  }
  return at;
}
} // namespace

template <int Dim> std::int64_t Body<Dim>::number(const Site<Dim>& cell) const
{
  std::int64_t n = 0;
  for (std::size_t d = Dim; d-- > 0;) n = n * cells[d] + cell[d];
  return n;
}

template <int Dim> Site<Dim> Body<Dim>::cell(std::int64_t number) const
{
  Site<Dim> at{};
  for (std::size_t d = 0; d < Dim; ++d) {
    at[d] = static_cast<Index>(number % cells[d]);
    number /= cells[d];
  }
  return at;
}

template <int Dim> std::uint64_t Body<Dim>::points_in(const Site<Dim>& cell) const
{
  for (std::size_t d = 0; d < Dim; ++d)
    if (cell[d] < 0 || cell[d] >= cells[d]) return 0;
  return points[static_cast<std::size_t>(number(cell))];
}

template <int Dim> Vector<Dim> Body<Dim>::node(const Site<Dim>& at) const
{
  Vector<Dim> x = corner;
  for (std::size_t d = 0; d < Dim; ++d) x[static_cast<Eigen::Index>(d)] += at[d] * cell_size();
  return x;
}

template <int Dim> Vector<Dim> Body<Dim>::place(const Site<Dim>& cell, int site) const
{
  Site<Dim> at = site_in_cell<Dim>(site, material.ratio);
  for (std::size_t d = 0; d < Dim; ++d) at[d] += cell[d] * material.ratio;
  return place_of(at);
}

template <int Dim> Vector<Dim> Body<Dim>::place_of(const Site<Dim>& site) const
{
  Vector<Dim> x = corner;
  for (std::size_t d = 0; d < Dim; ++d) x[static_cast<Eigen::Index>(d)] += (site[d] + 0.5) * material.spacing;
  return x;
}

template <int Dim> std::int64_t Body<Dim>::count() const
{
  std::int64_t n = 0;
  for (const std::uint64_t bits : points) n += std::popcount(bits);
  return n;
}

template <int Dim> Vector<Dim> Body<Dim>::centre() const
{
  Vector<Dim> sum = Vector<Dim>::Zero();
  for_each_place([&](const Vector<Dim>& x) { sum += x - corner; });
  return corner + sum / static_cast<double>(count());
}

template <int Dim> geom::Box<Dim> Body<Dim>::around() const
{
  constexpr double far = std::numeric_limits<double>::max();
  geom::Box<Dim> box{Vector<Dim>::Constant(far), Vector<Dim>::Constant(-far)};
  for_each_place([&](const Vector<Dim>& x) {
    box.lower = box.lower.cwiseMin(x).eval();
    box.upper = box.upper.cwiseMax(x).eval();
  });
  box.lower.array() -= 0.5 * material.spacing;
  box.upper.array() += 0.5 * material.spacing;
  return box;
}

template <int Dim> bool Body<Dim>::has(const Site<Dim>& site) const
{
  Site<Dim> in{};
  int bit = 0;
  for (std::size_t d = Dim; d-- > 0;) {
    if (site[d] < 0) return false;
    in[d] = site[d] / material.ratio;
    bit = bit * material.ratio + site[d] % material.ratio;
  }
  return points_in(in) >> bit & 1U;
}

template <int Dim> unsigned Body<Dim>::uncovered(const Site<Dim>& cell, int site) const
{
  Site<Dim> own = site_in_cell<Dim>(site, material.ratio);
  for (std::size_t d = 0; d < Dim; ++d) own[d] += cell[d] * material.ratio;
  unsigned directions = 0;
  for (std::size_t d = 0; d < Dim; ++d)
    for (const Index step : {-1, 1}) {
      Site<Dim> beside = own;
      beside[d] += step;
      if (!has(beside)) directions |= 1U << d;
    }
  return directions;
}

template <int Dim> Vector<Dim> Body<Dim>::skin_place(const Site<Dim>& cell, int site) const
{
  const Vector<Dim> x = place(cell, site);
  return skin ? skin(x, uncovered(cell, site)) : x;
}

template <int Dim>
Body<Dim> fill_body(std::string name, const BodyMaterial& material, const geom::Box<Dim>& reach,
                    const std::function<bool(const Vector<Dim>&)>& inside)
{
  Body<Dim> body{std::move(name), material, reach.lower, {}, {}, {}};
  double count = 1.0;
  for (std::size_t d = 0; d < Dim; ++d) {
    const auto a = static_cast<Eigen::Index>(d);
    const double wide = std::max(1.0, std::ceil((reach.upper[a] - reach.lower[a]) / body.cell_size() - kWhole));
    count *= wide;
    if (count > kMostCells)
      throw UserError(fmt::format("body {}: a spacing of {:g} m makes more cells than the {:.3g} that can be numbered",
                                  body.name, material.spacing, kMostCells));
    body.cells[d] = static_cast<Index>(wide);
  }
  body.points.resize(static_cast<std::size_t>(count));
  int sites = 1;
  for (int d = 0; d < Dim; ++d) sites *= material.ratio;
  for (std::size_t k = 0; k < body.points.size(); ++k) {
    const Site<Dim> cell = body.cell(static_cast<std::int64_t>(k));
    for (int site = 0; site < sites; ++site)
      if (inside(body.place(cell, site))) body.points[k] |= std::uint64_t{1} << site;
  }
  if (body.count() == 0)
    throw UserError(fmt::format("body {}: no point lies in its shape at a spacing of {:g} m: make it finer", body.name,
                                material.spacing));
  return body;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template struct Body<Dim>;                                                                                           \
  template Body<Dim> fill_body<Dim>(std::string, const BodyMaterial&, const geom::Box<Dim>&,                           \
                                    const std::function<bool(const Vector<Dim>&)>&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
