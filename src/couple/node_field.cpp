#include "pdx/couple/node_field.hpp"

#include "pdx/mesh/vertex_halo.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pdx::couple {
namespace {
/// Adds what gives the displacement at x: the four particles around it by their bilinear weights, three of them by the
/// plane through them, else the nearest four that are there; beyond the outermost the function continues.
void around(const pd::LatticePart<2>& part, const Vector<2>& x, std::vector<Index>& sites, std::vector<double>& weights)
{
  const geom::Lattice<2>& lattice = part.lattice();
  const auto& count = lattice.count;
  Site<2> base{};
  std::array<double, 2> f{};
  for (std::size_t d = 0; d < 2; ++d) {
    f[d] = (x[static_cast<Eigen::Index>(d)] - lattice.origin[static_cast<Eigen::Index>(d)]) / lattice.dx - 0.5;
    base[d] = std::clamp(static_cast<Index>(std::floor(f[d])), Index{0}, std::max(Index{0}, count[d] - 2));
  }
  const auto corner = [&count](const Site<2>& low, std::size_t a) {
    const auto i = static_cast<Index>(a % 2), j = static_cast<Index>(a / 2);
    return Site<2>{std::min(low[0] + i, count[0] - 1), std::min(low[1] + j, count[1] - 1)};
  };
  const auto missing = [&](const Site<2>& low) { // a bit for each corner
    unsigned none = 0;
    for (std::size_t a = 0; a < 4; ++a) none |= unsigned{!part.active().has(corner(low, a))} << a;
    return none;
  };
  const auto count_of = [&missing](const Site<2>& low) { return std::popcount(missing(low)); };
  Site<2> low = base;
  int fewest = count_of(base);
  for (Site<2> step{0, -1}; step[1] <= 1; ++step[1])
    for (step[0] = -1; step[0] <= 1 && fewest > 1; ++step[0])
      if (const Site<2> other{base[0] + step[0], base[1] + step[1]}; count_of(other) < fewest) {
        fewest = count_of(other);
        low = other;
      }
  std::array<double, 2> t{};
  for (std::size_t d = 0; d < 2; ++d) t[d] = count[d] > 1 ? f[d] - low[d] : 0.0;
  std::array<double, 4> w{(1.0 - t[0]) * (1.0 - t[1]), t[0] * (1.0 - t[1]), (1.0 - t[0]) * t[1], t[0] * t[1]};
  const unsigned none = missing(low);
  if (fewest == 1) {
    const auto gone = static_cast<std::size_t>(std::countr_zero(none));
    w[gone ^ 1u] += w[gone];
    w[gone ^ 2u] += w[gone];
    w[gone ^ 3u] -= w[gone];
  } else if (none) { // a patch one particle wide
    w.fill(0.0);
    for (std::size_t a = 0; a < 4; ++a)
      if (part.active().has(corner(low, a))) w[a] = 1.0 / (4 - fewest);
  }
  for (std::size_t a = 0; a < 4; ++a) {
    if (none >> a & 1u) continue;
    sites.push_back(part.number(corner(low, a)));
    weights.push_back(w[a]);
  }
}
} // namespace

NodeField::NodeField(const mesh::Mesh& mesh, std::span<const PetscInt> node_rows,
                     std::span<const std::unique_ptr<pd::LatticePart<2>>> parts)
    : mesh_(mesh), node_rows_(node_rows)
{
  std::vector<std::pair<Index, int>> covered; // with their patch, of several the last
  for (const Index c : mesh.cells(mesh::Use::covered))
    for (const Index v : mesh.cell(c))
      if (v < mesh.owned_vertices() && node_rows[static_cast<std::size_t>(v)] < 0)
        covered.emplace_back(v, mesh.patch(c));
  std::ranges::stable_sort(covered, {}, [](const auto& at) { return at.first; });
  std::vector<std::vector<Index>> sites(parts.size()); // asked of each patch, in order of vertices
  std::vector<std::size_t> patches;
  for (std::size_t k = 0; k < covered.size(); ++k) {
    const auto [v, patch] = covered[k];
    if (k + 1 < covered.size() && covered[k + 1].first == v) continue;
    covered_.push_back(v);
    patches.push_back(static_cast<std::size_t>(patch));
    around(*parts[patches.back()], mesh.point(v), sites[patches.back()], weights_);
    offsets_.push_back(weights_.size());
  }
  std::vector<std::vector<PetscInt>> answers;
  for (std::size_t p = 0; p < parts.size(); ++p) answers.push_back(parts[p]->directory().rows(sites[p]));
  std::vector<std::size_t> next(parts.size(), 0);
  for (std::size_t k = 0; k < covered_.size(); ++k)
    for (std::size_t at = offsets_[k]; at < offsets_[k + 1]; ++at)
      rows_.push_back(answers[patches[k]][next[patches[k]]++]);
}

void NodeField::bind(const field::RowHalo& halo)
{
  first_ = halo.rows().first;
  for (PetscInt& row : rows_) row = halo.local(row);
}

std::vector<double> NodeField::displacement(std::span<const double> u) const
{
  std::vector<double> all(static_cast<std::size_t>(mesh_.vertices()) * 2, 0.0);
  for (Index v = 0; v < mesh_.owned_vertices(); ++v)
    if (const PetscInt row = node_rows_[static_cast<std::size_t>(v)] - first_; row >= 0)
      std::copy_n(u.begin() + 2 * row, 2, all.begin() + 2 * v);
  for (std::size_t v = 0; v < covered_.size(); ++v)
    for (std::size_t k = offsets_[v]; k < offsets_[v + 1]; ++k)
      for (std::size_t a = 0; a < 2; ++a)
        all[2 * static_cast<std::size_t>(covered_[v]) + a] +=
            weights_[k] * u[2 * static_cast<std::size_t>(rows_[k]) + a];
  mesh::fill_halo(mesh_, MPI_DOUBLE, 2, all.data());
  return all;
}
} // namespace pdx::couple
