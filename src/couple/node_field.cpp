#include "pdx/couple/node_field.hpp"

#include "pdx/mesh/vertex_halo.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::couple {
namespace {
/// The four sites around x and their bilinear weights; beyond the outermost sites the bilinear function continues.
void around(const geom::Lattice<2>& lattice, const Vector<2>& x, std::vector<Index>& sites,
            std::vector<double>& weights)
{
  std::array<Index, 2> base{};
  std::array<double, 2> t{};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto e = static_cast<Eigen::Index>(d);
    const double f = (x[e] - lattice.origin[e]) / lattice.dx - 0.5;
    base[d] = std::clamp(static_cast<Index>(std::floor(f)), Index{0}, std::max(Index{0}, lattice.count[d] - 2));
    t[d] = lattice.count[d] > 1 ? f - base[d] : 0.0;
  }
  for (Index j = 0; j < 2; ++j)
    for (Index i = 0; i < 2; ++i) {
      const Site<2> site{std::min(base[0] + i, lattice.count[0] - 1), std::min(base[1] + j, lattice.count[1] - 1)};
      sites.push_back(static_cast<Index>(lattice.number(site)));
      weights.push_back((i ? t[0] : 1.0 - t[0]) * (j ? t[1] : 1.0 - t[1]));
    }
}
} // namespace

NodeField::NodeField(const mesh::Mesh& mesh, std::span<const PetscInt> node_rows,
                     std::span<const std::unique_ptr<pd::LatticePart<2>>> parts)
    : mesh_(mesh)
{
  std::vector<int> patch(static_cast<std::size_t>(mesh.vertices()), -1);
  for (const Index c : mesh.cells(mesh::Use::covered))
    for (const Index v : mesh.cell(c)) patch[static_cast<std::size_t>(v)] = mesh.patch(c);

  std::vector<std::vector<Index>> sites(parts.size()); // asked of each patch, in order of vertices
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const auto k = static_cast<std::size_t>(v);
    if (node_rows[k] >= 0) {
      rows_.push_back(node_rows[k]);
      weights_.push_back(1.0);
    } else if (patch[k] >= 0) {
      const auto p = static_cast<std::size_t>(patch[k]);
      around(parts[p]->lattice(), mesh.point(v), sites[p], weights_);
      rows_.resize(weights_.size(), -1);
    }
    offsets_.push_back(rows_.size());
  }
  std::vector<std::vector<PetscInt>> answers;
  for (std::size_t p = 0; p < parts.size(); ++p) answers.push_back(parts[p]->directory().rows(sites[p]));
  std::vector<std::size_t> next(parts.size(), 0);
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const auto k = static_cast<std::size_t>(v);
    for (std::size_t at = offsets_[k]; at < offsets_[k + 1]; ++at)
      if (rows_[at] < 0) {
        const auto p = static_cast<std::size_t>(patch[k]);
        rows_[at] = answers[p][next[p]++];
      }
  }
}

void NodeField::bind(const field::RowHalo& halo)
{
  for (PetscInt& row : rows_) row = halo.local(row);
}

std::vector<double> NodeField::displacement(std::span<const double> u) const
{
  std::vector<double> all(static_cast<std::size_t>(mesh_.vertices()) * 2, 0.0);
  for (std::size_t v = 0; v + 1 < offsets_.size(); ++v)
    for (std::size_t k = offsets_[v]; k < offsets_[v + 1]; ++k)
      for (std::size_t a = 0; a < 2; ++a) all[2 * v + a] += weights_[k] * u[2 * static_cast<std::size_t>(rows_[k]) + a];
  mesh::fill_halo(mesh_, MPI_DOUBLE, 2, all.data());
  return all;
}
} // namespace pdx::couple
