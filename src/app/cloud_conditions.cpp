#include "pdx/app/cloud_body.hpp"
#include "pdx/base/gather.hpp"

#include <fmt/format.h>

namespace pdx::app {
namespace {
template <int Dim> class Conditions {
public:
  Conditions(const SceneOptions& options, CloudBody<Dim>& body)
      : options_(options), body_(body), entries_(options, body)
  {}

  void apply()
  {
    for (const BoundaryCondition& c : options_.conditions) {
      if (c.holds()) entries_.hold(c, rows_of(c, "displacement or velocity"));
      if (c.initial_velocity) entries_.throw_in(c, rows_of(c, "initial velocity"));
      if (!c.body && !c.force) continue;
      force_.assign(static_cast<std::size_t>(body_.system.rows.owned()) * Dim, 0.0);
      if (c.body) add(rows_of(c, "body force"), *c.body);
      if (c.force) spread(rows_of(c, "force"), *c.force);
      entries_.load(c, force_);
    }
    entries_.finish();
  }

private:
  std::set<Index> rows_of(const BoundaryCondition& c, const char* what) const
  {
    std::set<Index> rows;
    for (Index k = 0; k < body_.system.rows.owned(); ++k) {
      const double* x = &body_.system.coordinates[static_cast<std::size_t>(Dim * k)];
      const bool inside = !c.box || c.box->contains(Vector<2>(x[0], x[1]), 1e-6 * options_.pd.horizon);
      if (inside && (!c.set || *c.set == body_.sets[static_cast<std::size_t>(k)])) rows.insert(k);
    }
    if (any_rank(body_.system.rows.comm, !rows.empty())) return rows;
    if (c.set && !c.box)
      throw UserError(fmt::format("-bc_{}_set is {}: no particle has it for the {} to act on", c.name, *c.set, what));
    throw UserError(fmt::format("-bc_{}_box: no particle {}lies there for the {} to act on", c.name,
                                c.set ? fmt::format("of the set {} ", *c.set) : "", what));
  }

  void add(const std::set<Index>& rows, const Vector<3>& density)
  {
    for (const Index row : rows)
      for (Index a = 0; a < Dim; ++a)
        force_[static_cast<std::size_t>(Dim * row + a)] +=
            body_.bonds->volumes()[static_cast<std::size_t>(row)] * density[a];
  }

  /// By volume.
  void spread(const std::set<Index>& rows, const Vector<3>& force)
  {
    double volume = 0.0;
    for (const Index row : rows) volume += body_.bonds->volumes()[static_cast<std::size_t>(row)];
    MPI_Allreduce(MPI_IN_PLACE, &volume, 1, MPI_DOUBLE, MPI_SUM, body_.system.rows.comm);
    add(rows, force / volume);
  }

  const SceneOptions& options_;
  CloudBody<Dim>& body_;
  Prescriptions entries_;
  std::vector<double> force_; // of one condition [N]
};

/// Options that are of elements, lattices or equilibria.
constexpr const char* kStrange[] = {"-mesh_file",       "-mesh_lower",      "-mesh_upper",         "-mesh_cells",
                                    "-pd_patches",      "-pd_spacing",      "-pd_horizon_ratio",   "-pd_operator",
                                    "-couple_scheme",   "-xfem_quadrature", "-xfem_least_share",   "-pd_skip_tolerance",
                                    "-post_j_contours", "-post_j_domain",   "-post_energy_release"};

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
  if (c.at || c.layer)
    throw UserError(fmt::format("{0}_{1} has no meaning for a cloud: choose particles by {0}_box or {0}_set", stem,
                                c.at ? "at" : "layer"));
  if (c.force && !c.box && !c.set)
    throw UserError(fmt::format("{0}_force: no place given: choose particles by {0}_box or {0}_set", stem));
}
} // namespace

template <int Dim> void apply_conditions(const SceneOptions& options, CloudBody<Dim>& body)
{
  Conditions<Dim>(options, body).apply();
}
template void apply_conditions<2>(const SceneOptions&, CloudBody<2>&);
template void apply_conditions<3>(const SceneOptions&, CloudBody<3>&);

void judge_cloud(const SceneOptions& s)
{
  const Options o("pd");
  for (const char* name : kStrange)
    if (o.given(name)) throw UserError(fmt::format("{} has no meaning for the particles of -pd_cloud: drop it", name));
  if (s.solid && o.given("-material_thickness"))
    throw UserError("-material_thickness has no meaning for a cloud in space: its particles have volumes; drop it");
  if (s.time.analysis != Analysis::explicit_dynamics)
    throw UserError("-pd_cloud needs -analysis explicit: bonds of a cloud have no tangent");
  for (const char* name : {"-pd_calibration", "-pd_toughness"})
    if (o.given(name) &&
        (name[4] == 'c' ? s.pd.calibration != pd::Calibration::continuum : s.fracture.by != pd::Toughness::continuum))
      throw UserError(fmt::format("{} lattice is of lattices: bonds of a cloud have the continuum's; drop it", name));
  if (s.pd.surface_correction == SurfaceCorrection::volume)
    throw UserError("-pd_surface_correction volume is of lattices: a cloud has none; drop it");
  for (const BoundaryCondition& c : s.conditions) judge_condition(c);
}
} // namespace pdx::app
