#pragma once
#include "pdx/mesh/mesh.hpp"

#include <functional>

namespace pdx::adapt {
/// Sums at some vertices of a mesh to which every rank adds what its own cells hold.
class VertexSums {
public:
  /// @param width of a vertex   @param boxes that hold what may be wanted [m]
  /// @param wanted alike for a vertex on every rank that has it
  VertexSums(const mesh::Mesh& mesh, std::size_t width, std::span<const geom::Box<2>> boxes,
             const std::function<bool(Index vertex)>& wanted);
  std::span<const Index> vertices() const { return vertices_; } ///< that are wanted, ascending
  bool wanted(Index vertex) const { return place_[static_cast<std::size_t>(vertex)] >= 0; }
  double* at(Index vertex) { return sums_.data() + place(vertex); }
  const double* at(Index vertex) const { return sums_.data() + place(vertex); }
  /// Every rank that has a vertex has the sums of all ranks then, alike to the last bit. Collective.
  void sum_up();

private:
  std::size_t place(Index vertex) const
  {
    return static_cast<std::size_t>(place_[static_cast<std::size_t>(vertex)]) * width_;
  }

  const mesh::Mesh& mesh_;
  std::size_t width_;
  std::vector<Index> vertices_;
  std::vector<Index> place_; // per local vertex, -1: not wanted
  std::vector<double> sums_;
};
} // namespace pdx::adapt
