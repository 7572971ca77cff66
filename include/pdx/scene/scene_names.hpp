#pragma once
#include "pdx/scene/standing.hpp"

namespace pdx::scene {
/// What the rows of a scene are called, on any ranks and under any layout.
class SceneNames {
public:
  /// What `scene` points to must outlive this. The rows of enriched sets are numbered.
  explicit SceneNames(const Standing& scene);

  /// The same of some owned rows, ascending: only for these is there a name.
  SceneNames(const Standing& scene, std::span<const Index> rows);

  std::span<const field::RowName> rows() const { return rows_; } ///< owned, in their order
  std::span<const field::RowName> particles() const;             ///< the last of them

  /// Whether a CrackWatch looks at owned particle k.
  bool is_watched(std::size_t k) const;

private:
  const Model& model_;
  std::vector<field::RowName> rows_;
  std::size_t particles_ = 0;
};
} // namespace pdx::scene
