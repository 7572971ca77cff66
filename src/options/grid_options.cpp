#include "pdx/options/scene_options.hpp"

#include <fmt/format.h>

namespace pdx::options {
void judge_grid(const SceneOptions& s)
{
  const Options o("mpm");
  const bool updated = s.points.formulation == Formulation::updated;
  for (const char* name : {"-mpm_order", "-mpm_shape", "-mpm_pic"})
    if (!updated && o.given(name))
      throw UserError(
          fmt::format("{} is of a grid that is made anew: give -mpm_formulation updated, or drop it", name));
  if (!updated) return;
  if (s.time.analysis != Analysis::explicit_dynamics)
    throw UserError("-mpm_formulation updated makes its grid anew each step: give -analysis explicit");
  if (o.given("-mpm_skip_rest"))
    throw UserError(
        "-mpm_skip_rest is of -mpm_formulation total: on a grid made anew no cell keeps its points; drop it");
  for (const char* name : {"-contact", "-contact_stiffness", "-contact_friction", "-contact_skin"})
    if (o.given(name))
      throw UserError(fmt::format(
          "{} is of -mpm_formulation total: bodies on one grid meet on its nodes, and stick; drop it", name));
  if (s.points.viscosity > 0.0)
    throw UserError("-mpm_bulk_viscosity is of -mpm_formulation total: drop it, or give that");
  for (const BoundaryCondition& c : s.conditions) {
    const std::string stem = "-bc_" + c.name;
    if (c.traction)
      throw UserError(fmt::format("{0}_traction is of -mpm_formulation total: give {0}_body or {0}_velocity", stem));
    if (c.springs || c.pin)
      throw UserError(
          fmt::format("{0}_{1} is of -mpm_formulation total: give that, or drop it", stem, c.pin ? "pin" : "spring"));
    if (c.body && c.box)
      throw UserError(
          fmt::format("{0}_body acts on whole bodies with -mpm_formulation updated: drop {0}_box, or choose "
                      "by {0}_of",
                      stem));
    if (c.initial_velocity && !c.on.empty())
      throw UserError(fmt::format("{0}_initial_velocity acts on points with -mpm_formulation updated: choose them by "
                                  "{0}_box or {0}_of",
                                  stem));
  }
}
} // namespace pdx::options
