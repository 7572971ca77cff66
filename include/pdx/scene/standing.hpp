#pragma once
#include "pdx/scene/model.hpp"

namespace pdx::scene {
/// The scene a run is about, once it stands. What is pointed to lives until another scene takes its place.
struct Standing {
  mesh::Mesh* mesh = nullptr;
  const Model* model = nullptr;
};
} // namespace pdx::scene
