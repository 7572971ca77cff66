#include "pdx/adapt/vertex_sums.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <unordered_map>

namespace pdx::adapt {
VertexSums::VertexSums(const mesh::Mesh& mesh, std::size_t width, std::span<const geom::Box<2>> boxes,
                       const std::function<bool(Index)>& wanted)
    : mesh_(mesh), width_(width), place_(static_cast<std::size_t>(mesh.vertices()), -1)
{
  std::vector<Index> near;
  for (const Index c : mesh.finder().around(boxes)) near.insert(near.end(), mesh.cell(c).begin(), mesh.cell(c).end());
  std::ranges::sort(near);
  near.erase(std::unique(near.begin(), near.end()), near.end());
  for (const Index v : near) {
    if (!wanted(v)) continue;
    place_[static_cast<std::size_t>(v)] = static_cast<Index>(vertices_.size());
    vertices_.push_back(v);
  }
  sums_.assign(vertices_.size() * width, 0.0);
}

/// A list of what is near a change, not of the mesh.
void VertexSums::sum_up()
{
  int ranks = 1;
  MPI_Comm_size(mesh_.comm(), &ranks);
  if (ranks == 1) return;
  std::vector<double> mine; // natural number, sums
  std::unordered_map<Index, Index> vertex_of;
  for (const Index v : vertices_) {
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
