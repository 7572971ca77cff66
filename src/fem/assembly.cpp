#include "pdx/fem/assembly.hpp"

#include "pdx/fem/elastic_kernel.hpp"

#include <algorithm>
#include <limits>

namespace pdx::fem {
namespace {
bool same_shape(const Corners& a, const Corners& b)
{
  const double size = std::max((a[2] - a[0]).norm(), (a[3] - a[1]).norm());
  const double reach = std::max(a[0].lpNorm<Eigen::Infinity>(), b[0].lpNorm<Eigen::Infinity>()) + size;
  const double tolerance = 1e-12 * size + 4.0 * std::numeric_limits<double>::epsilon() * reach;
  for (std::size_t k = 1; k < 4; ++k)
    if (((a[k] - a[0]) - (b[k] - b[0])).lpNorm<Eigen::Infinity>() > tolerance) return false;
  return true;
}
} // namespace

const ElementMatrix& ReusedStiffness::of(const Corners& corners)
{
  if (!last_ || !same_shape(*last_, corners)) {
    matrix_ = element_tangent(corners, ElementVector::Zero(), law_, Kinematics::small);
    last_ = corners;
    ++integrations_;
  }
  return matrix_;
}

std::vector<ReusedStiffness> reused_stiffness(const ElasticBody& body)
{
  std::vector<ReusedStiffness> all;
  for (std::size_t k = 0; k < body.laws(); ++k) all.emplace_back(body.regions ? body.regions->elastic(k) : body.law);
  return all;
}

void count_couplings(const mesh::Mesh& mesh, std::span<const Index> cells, std::span<const Index> local_rows,
                     field::Couplings& couplings)
{
  const Index owned = couplings.halo.rows().owned();
  std::vector<std::size_t> offsets(static_cast<std::size_t>(owned) + 1, 0); // room for 3 neighbours per cell and row
  const auto for_each_owned = [&](auto&& visit) {
    for (const Index c : cells)
      for (const Index v : mesh.cell(c))
        if (const Index row = local_rows[static_cast<std::size_t>(v)]; row < owned)
          visit(c, v, static_cast<std::size_t>(row));
  };
  for_each_owned([&](Index, Index, std::size_t row) { offsets[row + 1] += 3; });
  for (std::size_t row = 0; row + 1 < offsets.size(); ++row) offsets[row + 1] += offsets[row];
  std::vector<Index> neighbours(offsets.back());
  std::vector<std::size_t> ends(offsets.begin(), offsets.end() - 1);
  for_each_owned([&](Index c, Index v, std::size_t row) {
    const auto begin = neighbours.begin() + static_cast<std::ptrdiff_t>(offsets[row]);
    for (const Index w : mesh.cell(c)) {
      const Index column = local_rows[static_cast<std::size_t>(w)];
      const auto end = neighbours.begin() + static_cast<std::ptrdiff_t>(ends[row]);
      if (w == v || std::find(begin, end, column) != end) continue;
      neighbours[ends[row]++] = column;
      couplings.add(static_cast<Index>(row), column);
    }
  });
}

void assemble_stiffness(const ElasticBody& body, std::span<const Index> cells, std::span<const Index> local_rows,
                        std::span<const double> displacement, field::BlockAdder& adder)
{
  std::vector<ReusedStiffness> reused = reused_stiffness(body);
  const bool straight = body.kinematics == Kinematics::small || displacement.empty();
  for (const Index c : cells) {
    const auto& vertices = body.mesh.cell(c);
    std::array<Index, 4> rows;
    ElementVector d = ElementVector::Zero();
    for (std::size_t a = 0; a < 4; ++a) {
      const auto v = static_cast<std::size_t>(vertices[a]);
      rows[a] = local_rows[v];
      if (!straight) d.segment<2>(static_cast<Index>(2 * a)) << displacement[2 * v], displacement[2 * v + 1];
    }
    const Corners corners = body.mesh.corners(c);
    const ElementMatrix k =
        straight ? reused[body.number(c)].of(corners) : element_tangent(corners, d, body.law_of(c), body.kinematics);
    adder.add(rows, rows, {k.data(), static_cast<std::size_t>(k.size())});
  }
}
} // namespace pdx::fem
