#pragma once
#include "pdx/options/materials.hpp"
#include "pdx/options/scene_options.hpp"

namespace pdx::options {
/// `-material_...`. Throws UserError. @param named what is not given is that of it   @param solid is it in space?
law::Elastic read_material(const Material& named, bool describe, bool& solid);
/// The material as bonds can have it: one by name has a Poisson's ratio of its own, and they take theirs.
law::Elastic of_bonds(const SceneOptions& options, const Material& named);
/// One ratio for bonds and elements, the one that bonds were found to have; says so where it is another than given.
void take_required_poisson(SceneOptions& options);
} // namespace pdx::options
