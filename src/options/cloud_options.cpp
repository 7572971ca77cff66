#include "pdx/options/scene_options.hpp"

#include <fmt/format.h>

namespace pdx::options {
namespace {
/// Options that are of elements, lattices or equilibria.
constexpr const char* kStrange[] = {
    "-mesh_file",        "-mesh_lower",        "-mesh_upper",       "-mesh_cells",    "-pd_patches",
    "-pd_spacing",       "-pd_horizon_ratio",  "-pd_operator",      "-couple_scheme", "-xfem_quadrature",
    "-xfem_least_share", "-pd_skip_tolerance", "-post_j_contours",  "-post_j_domain", "-post_energy_release",
    "-post_tip_damage",  "-post_modes",        "-couple_face_mass", "-pd_scatter",    "-pd_scatter_seed"};

void judge_cloud_condition(const BoundaryCondition& c)
{
  const std::string stem = "-bc_" + c.name;
  if (!c.on.empty())
    throw UserError(
        fmt::format("{0}_on is {1}: a cloud has no sides: choose particles by {0}_box or {0}_set", stem, c.on));
  if (c.traction)
    throw UserError(
        fmt::format("{0}_traction needs a surface, and a cloud has none: give {0}_force in all, or {0}_body, "
                    "with {0}_box or {0}_set",
                    stem));
  if ((c.at && !c.pin) || c.layer || c.rows != 1)
    throw UserError(fmt::format("{0}_{1} has no meaning for a cloud: choose particles by {0}_box or {0}_set", stem,
                                c.at      ? "at"
                                : c.layer ? "layer"
                                          : "rows"));
  if (c.force && !c.box && !c.set)
    throw UserError(fmt::format("{0}_force: no place given: choose particles by {0}_box or {0}_set", stem));
}
} // namespace

void judge_cloud(const SceneOptions& s)
{
  const Options o("pd");
  for (const char* name : kStrange)
    if (o.given(name)) throw UserError(fmt::format("{} has no meaning for the particles of -pd_cloud: drop it", name));
  if (s.solid && o.given("-material_thickness"))
    throw UserError("-material_thickness has no meaning for a cloud in space: its particles have volumes; drop it");
  if (s.time.analysis != Analysis::explicit_dynamics)
    throw UserError("-pd_cloud needs -analysis explicit: bonds of a cloud have no tangent");
  const auto refuse_lattice = [&](const char* name, bool lattice) {
    if (o.given(name) && lattice)
      throw UserError(fmt::format("{} lattice is of lattices: bonds of a cloud have the continuum's; drop it", name));
  };
  refuse_lattice("-pd_calibration", s.pd.calibration == pd::Calibration::lattice);
  refuse_lattice("-pd_toughness", s.fracture.by == pd::Toughness::lattice);
  if (s.pd.surface_correction == SurfaceCorrection::volume || s.pd.surface_correction == SurfaceCorrection::exact)
    throw UserError("-pd_surface_correction is of lattices, which a cloud is not: drop it, or give none");
  for (const BoundaryCondition& c : s.conditions) judge_cloud_condition(c);
}
} // namespace pdx::options
