#pragma once
#include "pdx/mesh/mesh.hpp"

#include <Eigen/Core>
#include <vector>

namespace pdx::fem {
/// `corner_areas` of all cells of a mesh, worked out once: they stay right whatever its cells are used for.
class CornerAreas {
public:
  /// @param mesh must outlive this
  explicit CornerAreas(const mesh::Mesh& mesh) : mesh_(mesh) {}
  const Eigen::Vector4d& of(Index cell) const ///< [m^2]
  {
    if (areas_.empty()) work_out();
    return areas_[static_cast<std::size_t>(cell)];
  }

private:
  void work_out() const;

  const mesh::Mesh& mesh_;
  mutable std::vector<Eigen::Vector4d> areas_; // none before somebody asked
};
} // namespace pdx::fem
