#pragma once
#include "pdx/field/row_name.hpp"
#include "pdx/scene/standing.hpp"

namespace pdx::scene {
/// What the rows of a scene are called, on any ranks and under any layout.
class SceneNames {
public:
  /// What `scene` points to must outlive this. The rows of enriched sets are numbered.
  explicit SceneNames(const Standing& scene);

  std::span<const field::RowName> rows() const { return rows_; } ///< owned, in their order
  std::span<const field::RowName> particles() const;             ///< the last of them
  /// @param site as `pd::Particle::site`
  field::RowName particle(Index patch, Index site) const;

  /// Whether a CrackWatch looks at owned particle k: in a solid at those of the middle layer.
  bool is_watched(std::size_t k) const;

private:
  void add_particles();

  Standing scene_;
  std::vector<field::RowName> rows_;
};
} // namespace pdx::scene
