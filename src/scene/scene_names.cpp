#include "pdx/scene/scene_names.hpp"

#include <algorithm>

namespace pdx::scene {
SceneNames::SceneNames(const Standing& scene) : model_(*scene.model)
{
  for (const auto& part : model_.parts) part->add_names(rows_);
  particles_ = static_cast<std::size_t>(model_.system.rows.particles);
}

SceneNames::SceneNames(const Standing& scene, std::span<const Index> rows) : model_(*scene.model)
{
  for (const Index row : rows) {
    field::RowName name;
    for (const auto& part : model_.parts)
      if (name == field::RowName()) name = part->row_name(row);
    rows_.push_back(name);
    particles_ += row >= model_.system.rows.first_particle();
  }
}

std::span<const field::RowName> SceneNames::particles() const { return std::span(rows_).last(particles_); }

bool SceneNames::is_watched(std::size_t k) const
{
  return std::ranges::all_of(model_.parts, [k](const auto& part) { return part->watches(k); });
}
} // namespace pdx::scene
