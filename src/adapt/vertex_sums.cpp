#include "pdx/adapt/vertex_sums.hpp"

#include "pdx/base/block_type.hpp"

#include <algorithm>

namespace pdx::adapt {
VertexSums::VertexSums(const mesh::Mesh& mesh, std::size_t width, const std::function<bool(Index)>& wanted)
    : mesh_(mesh), width_(width), place_(static_cast<std::size_t>(mesh.vertices()), -1)
{
  Index count = 0;
  for (Index v = 0; v < mesh.vertices(); ++v)
    if (wanted(v)) place_[static_cast<std::size_t>(v)] = count++;
  sums_.assign(static_cast<std::size_t>(count) * width, 0.0);
}

void VertexSums::sum_up()
{
  if (!mesh_.vertex_sf()) return;
  std::vector<double> from(place_.size() * width_, 0.0);
  const auto copy_all = [&](auto&& copy) {
    for (std::size_t v = 0; v < place_.size(); ++v)
      if (place_[v] >= 0) copy(sums_.data() + static_cast<std::size_t>(place_[v]) * width_, v * width_);
  };
  copy_all([&](const double* sums, std::size_t to) {
    std::copy_n(sums, width_, from.begin() + static_cast<std::ptrdiff_t>(to));
  });
  std::vector<double> all = from;
  const MPI_Datatype type = block_type(static_cast<int>(width_));
  PDX_CALL(PetscSFReduceBegin(mesh_.vertex_sf(), type, from.data(), all.data(), MPI_SUM));
  PDX_CALL(PetscSFReduceEnd(mesh_.vertex_sf(), type, from.data(), all.data(), MPI_SUM));
  copy_all([&](double* sums, std::size_t to) { std::copy_n(all.data() + to, width_, sums); });
}
} // namespace pdx::adapt
