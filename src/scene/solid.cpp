#include "pdx/scene/solid.hpp"

#include "particle_part.hpp"
#include "pdx/mesh/sites.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
SolidPlan plan_solid(const options::SceneOptions& options, mesh::MeshOptions& mesh)
{
  const geom::Box<2>& body = mesh.box;
  const double depth = options.elastic.thickness;
  SolidPlan plan;
  plan.lattice = lattice_in<3>({{body.lower[0], body.lower[1], 0.0}, {body.upper[0], body.upper[1], depth}},
                               options.pd.spacing[0]);
  const double dx = plan.lattice.dx;
  plan.columns.body = body;
  plan.columns.shapes.push_back(
      couple::PatchShape::of_box(body, {body.lower, dx, {plan.lattice.count[0], plan.lattice.count[1]}}));
  try {
    plan.stencil = pd::make_stencil<3>(
        {dx, depth, options.pd.horizon_ratio * dx, options.pd.micromodulus, options.pd.calibration, options.elastic});
    pd::require_bond_words(plan.stencil);
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-pd_horizon_ratio is {}: {}", options.pd.horizon_ratio, wrong.what()));
  }
  plan.sides = solid_sides(options.pd, plan.stencil, true);
  if (mesh.cells[0] == 0) mesh.cells = background_cells(plan.columns.shapes[0].lattice);
  return plan;
}

mesh::CellCost cell_cost(const SolidPlan& plan)
{
  return [dx = plan.lattice.dx, layers = plan.lattice.count[2]](const std::array<Vector<2>, 4>& corners) {
    const Vector<2> a = corners[2] - corners[0], b = corners[3] - corners[1];
    const double columns = 0.5 * std::abs(a[0] * b[1] - a[1] * b[0]) / (dx * dx);
    return std::max(1, static_cast<int>(std::round(columns * layers)));
  };
}

std::vector<pd::Particle> make_particles(const mesh::Mesh& mesh, const SolidPlan& plan, pd::Particles& swarm)
{
  std::vector<pd::Particle> mine;
  const auto& columns = plan.columns.shapes[0].lattice;
  for (Index c = 0; c < mesh.owned_cells(); ++c)
    mesh::for_each_site(mesh, c, columns, 0, [&](const Site<2>& column, const Vector<2>& x) {
      for (Index layer = 0; layer < plan.lattice.count[2]; ++layer)
        mine.push_back({0, static_cast<Index>(plan.lattice.number({column[0], column[1], layer})), c, x});
    });
  auto total = static_cast<std::int64_t>(mine.size());
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, mesh.comm());
  if (const std::int64_t wanted = plan.lattice.total(); total != wanted)
    throw std::logic_error(fmt::format("{} particles found a cell, {} should have", total, wanted));
  swarm.add(mine);
  return swarm.sorted();
}

namespace {
void number_rows(MPI_Comm comm, const geom::Lattice<3>& lattice, Model& solid)
{
  solid.system.rows = field::Rows::number(comm, 3, 0, 0, static_cast<Index>(solid.particles.size()));
  for (const pd::Particle& particle : solid.particles) {
    const Vector<3> x = lattice.point(lattice.site(particle.site));
    solid.system.coordinates.insert(solid.system.coordinates.end(), {x[0], x[1], x[2]});
  }
}

pd::BondTerm<3>& add_bonds(const options::SceneOptions& options, const SolidPlan& plan, Model& solid)
{
  std::vector<Index> sites;
  for (const pd::Particle& particle : solid.particles) sites.push_back(particle.site);
  pd::SurfaceCorrection<3> correction;
  const pd::Exists<3> exists = [lattice = plan.lattice](const Site<3>& site) { return lattice.contains(site); };
  if (plan.sides)
    correction = pd::correct_sides(plan.stencil, *plan.sides, exists, &solid.cracks);
  else if (options.pd.surface_correction != options::SurfaceCorrection::none)
    correction = pd::correct_volumes<3>(plan.stencil, exists);
  std::vector<std::unique_ptr<pd::LatticePart<3>>> parts;
  parts.push_back(std::make_unique<pd::LatticePart<3>>(solid.system.rows, plan.lattice, plan.stencil, std::move(sites),
                                                       0, in_regions<3>(options, plan.stencil, std::move(correction)),
                                                       options.regions));
  parts.back()->scatter(options.fracture.scatter, {0, 0});
  auto owned = std::make_unique<pd::BondTerm<3>>(std::move(parts), options.bond_kinematics(), false);
  pd::BondTerm<3>& bonds = *owned;
  solid.system.terms.push_back(std::move(owned));
  if (!solid.cracks.empty()) bonds.cut(solid.cracks);
  return bonds;
}

/// From here on the bonds step in lane strips, with a toughness watched for breaking.
void step_explicitly(const options::SceneOptions& options, const SolidPlan& plan, pd::BondTerm<3>& bonds, Model& solid)
{
  if (!options.fracture.active()) return bonds.step_explicitly({});
  using Breaker = couple::StepBreaker<3>;
  solid.critical_stretch = {critical_stretch<3>(options, plan.stencil)};
  const couple::FractureRule rule{solid.critical_stretch, options.fracture.no_fail, options.fracture.release,
                                  options.fracture.release_share, options.bond_kinematics()};
  auto breaker = std::make_unique<Breaker>(bonds, nullptr, rule, Breaker::Steps::in_strips);
  solid.breaker = breaker.get();
  solid.system.after_step.push_back(std::move(breaker));
}

/// The particles of a solid; cracks are followed in the middle layer, whose sites have the names of the solid.
class SolidPart final : public ParticlePart<3> {
public:
  SolidPart(const Model& model, pd::BondTerm<3>& bonds) : ParticlePart<3>(model, bonds, nullptr) {}

  void add_names(std::vector<field::RowName>& names) const override
  {
    for (const pd::Particle& particle : model_.particles) names.push_back(name(0, particle.site));
  }
  void add_numbers(std::vector<PetscInt>& first) const override
  {
    first.push_back(first.back() + model_.system.rows.total);
  }
  std::string described() const override { return "solid = " + line_of<3>(lattice(), part().stencil().half.size()); }

  std::vector<track::TreeGround> grounds(const options::SceneOptions&) const override
  {
    const geom::Lattice<3>& all = lattice();
    const geom::Lattice<2> plane{all.origin.head<2>(), all.dx, {all.count[0], all.count[1]}};
    const std::int64_t before = std::int64_t{all.count[2] / 2} * all.count[1]; // rows of other layers
    return {{plane, part().stencil().horizon, {{0, before}, all.count[0], 0, 1}}};
  }
  bool watches(std::size_t k) const override
  {
    return lattice().site(model_.particles[k].site)[2] == lattice().count[2] / 2;
  }
  Watched watched() const override
  {
    const couple::ParticleDamage all = damage();
    std::vector<std::uint64_t> layer;
    std::vector<double> of_layer;
    for (std::size_t k = 0; k < model_.particles.size(); ++k) {
      if (!watches(k)) continue;
      layer.push_back(static_cast<std::uint64_t>(model_.particles[k].site));
      of_layer.push_back(all.damage[k] + all.precrack[k]);
    }
    return {std::move(of_layer), [layer = std::move(layer)](std::size_t k) { return layer[k]; }};
  }

private:
  const pd::LatticePart<3>& part() const { return *bonds_.parts()[0]; }
  const geom::Lattice<3>& lattice() const { return part().lattice(); }
  field::RowName name(std::size_t, Index site) const override
  {
    return field::RowName::particle(static_cast<std::uint64_t>(site));
  }
};
} // namespace

std::unique_ptr<Model> discretise(MPI_Comm comm, const options::SceneOptions& options, const SolidPlan& plan,
                                  std::vector<pd::Particle> particles)
{
  auto solid = std::make_unique<Model>();
  solid->particles = std::move(particles);
  solid->body = plan.columns.body;
  judge_no_fail(options, solid->body);
  solid->cracks = cracks_in(options, solid->body);
  number_rows(comm, plan.lattice, *solid);
  pd::BondTerm<3>& bonds = add_bonds(options, plan, *solid);
  solid->parts.push_back(std::make_unique<SolidPart>(*solid, bonds));
  apply_conditions(options, plan.lattice, *solid);
  solid->system.bind();
  step_explicitly(options, plan, bonds, *solid);
  bonds.skip_below(options.pd.skip_tolerance);
  return solid;
}
} // namespace pdx::scene
