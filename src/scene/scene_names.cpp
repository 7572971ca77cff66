#include "pdx/scene/scene_names.hpp"

#include <algorithm>

namespace pdx::scene {
SceneNames::SceneNames(const Standing& scene) : model_(*scene.model)
{
  for (const auto& part : model_.parts) part->add_names(rows_);
}

std::span<const field::RowName> SceneNames::particles() const
{
  return std::span(rows_).last(static_cast<std::size_t>(model_.system.rows.particles));
}

bool SceneNames::is_watched(std::size_t k) const
{
  return std::ranges::all_of(model_.parts, [k](const auto& part) { return part->watches(k); });
}
} // namespace pdx::scene
