#include "pdx/adapt/vertex_sums.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <unordered_map>

namespace pdx::adapt {
VertexSums::VertexSums(const mesh::Mesh& mesh, std::size_t width, const std::function<bool(Index)>& wanted)
    : mesh_(mesh), width_(width), place_(static_cast<std::size_t>(mesh.vertices()), -1)
{
  Index count = 0;
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (wanted(v)) place_[static_cast<std::size_t>(v)] = count++;
  sums_.assign(static_cast<std::size_t>(count) * width, 0.0);
}

/// A list of what is near a change, not of the mesh.
void VertexSums::sum_up()
{
  int ranks = 1;
  MPI_Comm_size(mesh_.comm(), &ranks);
  if (ranks == 1) return;
  std::vector<double> mine; // natural number, sums
  std::unordered_map<Index, Index> vertex_of;
  for (Index v = 0; v < mesh_.vertices(); ++v) {
    if (!wanted(v)) continue;
    vertex_of[mesh_.natural_vertex(v)] = v;
    mine.push_back(mesh_.natural_vertex(v));
    mine.insert(mine.end(), at(v), at(v) + width_);
  }
  const std::vector<double> all = gather_all(mesh_.comm(), mine);
  std::ranges::fill(sums_, 0.0);
  for (std::size_t k = 0; k < all.size(); k += width_ + 1) {
    const auto here = vertex_of.find(static_cast<Index>(all[k]));
    if (here == vertex_of.end()) continue;
    double* to = at(here->second);
    for (std::size_t i = 0; i < width_; ++i) to[i] += all[k + 1 + i];
  }
}
} // namespace pdx::adapt
