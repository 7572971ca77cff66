#include "pdx/app/cloud_body.hpp"
#include "pdx/base/gather.hpp"

#include <fmt/format.h>

namespace pdx::app {
namespace {
template <int Dim> class CloudConditions {
public:
  CloudConditions(const SceneOptions& options, const pd::Cloud<Dim>& cloud, CloudBody<Dim>& body)
      : options_(options), cloud_(cloud), body_(body)
  {}

  void apply()
  {
    const auto rows = [&](const BoundaryCondition& c, Acts acts) { return rows_of(c, word_of(acts)); };
    Prescriptions(options_, body_).enter(rows, [&](const BoundaryCondition& c, std::span<double> force) {
      if (c.body) add(rows_of(c, "body force"), *c.body, force);
      if (c.force) add(rows_of(c, "force"), *c.force / chosen_volume(c), force);
    });
  }

private:
  bool chosen(const BoundaryCondition& c, std::size_t number) const
  {
    if (c.box && !c.box->contains(cloud_.points[number].template head<2>(), 1e-6 * options_.pd.horizon)) return false;
    return !c.set || *c.set == cloud_.sets[number];
  }

  std::set<Index> rows_of(const BoundaryCondition& c, const char* what) const
  {
    std::set<Index> rows;
    for (std::size_t k = 0; k < body_.particles.size(); ++k)
      if (chosen(c, static_cast<std::size_t>(body_.particles[k].site))) rows.insert(static_cast<Index>(k));
    if (any_rank(body_.system.rows.comm, !rows.empty())) return rows;
    if (c.set && !c.box)
      throw UserError(fmt::format("-bc_{}_set is {}: no particle has it for the {} to act on", c.name, *c.set, what));
    throw UserError(fmt::format("-bc_{}_box: no particle {}lies there for the {} to act on", c.name,
                                c.set ? fmt::format("of the set {} ", *c.set) : "", what));
  }

  void add(const std::set<Index>& rows, const Vector<3>& density, std::span<double> force) const
  {
    for (const Index row : rows)
      for (Index a = 0; a < Dim; ++a)
        force[static_cast<std::size_t>(Dim * row + a)] +=
            body_.bonds->volumes()[static_cast<std::size_t>(row)] * density[a];
  }

  /// On all ranks, summed in the order of the file, so that nothing depends on their number [m^3].
  double chosen_volume(const BoundaryCondition& c) const
  {
    double volume = 0.0;
    for (std::size_t number = 0; number < cloud_.points.size(); ++number)
      if (chosen(c, number)) volume += cloud_.volumes[number];
    return volume;
  }

  const SceneOptions& options_;
  const pd::Cloud<Dim>& cloud_;
  CloudBody<Dim>& body_;
};

/// Options that are of elements, lattices or equilibria.
constexpr const char* kStrange[] = {
    "-mesh_file",       "-mesh_lower",      "-mesh_upper",          "-mesh_cells",
    "-pd_patches",      "-pd_spacing",      "-pd_horizon_ratio",    "-pd_operator",
    "-couple_scheme",   "-xfem_quadrature", "-xfem_least_share",    "-pd_skip_tolerance",
    "-post_j_contours", "-post_j_domain",   "-post_energy_release", "-post_tip_damage"};

void judge_condition(const BoundaryCondition& c)
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
  if (c.at || c.layer || c.rows != 1)
    throw UserError(fmt::format("{0}_{1} has no meaning for a cloud: choose particles by {0}_box or {0}_set", stem,
                                c.at      ? "at"
                                : c.layer ? "layer"
                                          : "rows"));
  if (c.force && !c.box && !c.set)
    throw UserError(fmt::format("{0}_force: no place given: choose particles by {0}_box or {0}_set", stem));
}
} // namespace

template <int Dim> void apply_conditions(const SceneOptions& options, const pd::Cloud<Dim>& cloud, CloudBody<Dim>& body)
{
  CloudConditions<Dim>(options, cloud, body).apply();
}
template void apply_conditions<2>(const SceneOptions&, const pd::Cloud<2>&, CloudBody<2>&);
template void apply_conditions<3>(const SceneOptions&, const pd::Cloud<3>&, CloudBody<3>&);

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
  for (const BoundaryCondition& c : s.conditions) judge_condition(c);
}
} // namespace pdx::app
