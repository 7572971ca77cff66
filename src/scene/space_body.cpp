#include "pdx/scene/space_body.hpp"

#include "broken_carried.hpp"
#include "particle_part.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/couple/step_breaker.hpp"
#include "pdx/scene/body_contact.hpp"
#include "pdx/scene/thrown_bodies.hpp"

#include <algorithm>
#include <bit>
#include <fmt/format.h>

namespace pdx::scene {
namespace space_body {
/// The material points that no particles have taken: their rows are nodes of the grids.
class SpacePoints final : public PointBody<3> {
public:
  SpacePoints(const SpaceBodies& bodies, const mesh::Mesh& background, SpaceModel& of)
      : PointBody<3>(bodies.points, background, of, &of.taken), space_(of)
  {}

  void add_numbers(std::vector<PetscInt>&) const override {} // particles are counted by themselves
  double own_kinetic(std::span<const double> velocity) const override
  {
    return model.bodies->kinetic(velocity, model.system.rows.nodes, static_cast<Index>(plan.bodies.size()));
  }
  void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const override
  {
    std::vector<double> velocity;
    model.system.halo->fetch(now.velocity, 3, velocity);
    int rank = 0;
    MPI_Comm_rank(model.system.rows.comm, &rank);
    blocks.push_back(point_block<3>(plan, owned_cells(), *term, now.local, velocity, rank, [&](const auto& cell) {
      return !space_.taken.has({cell.body, cell.at});
    }));
  }
  void add_columns(std::vector<io::Column>& columns) const override
  {
    columns.push_back({"points", "-"});
    PointBody<3>::add_columns(columns);
  }
  void add_row(std::span<const double> local, std::span<const double> velocity, std::vector<double>& row) const override
  {
    row.push_back(static_cast<double>(model.material_points));
    PointBody<3>::add_row(local, velocity, row);
  }
  bool works_in(const field::Term& of) const override { return &of == term; }
  void add_shares(std::vector<double>& cells) const override
  {
    for (Index c = 0; c < mesh.owned_cells(); ++c) {
      const auto& column = plan.cells[static_cast<std::size_t>(mesh.natural_cell(c))];
      for (const Index layer : plan.cell_layers(column))
        if (const Site<3> at{column.at[0], column.at[1], layer}; !space_.taken.has({column.body, at}))
          cells[static_cast<std::size_t>(c)] +=
              std::popcount(plan.bodies[static_cast<std::size_t>(column.body)].points_in(at));
    }
  }

private:
  const SpaceModel& space_;
};

/// The particles that have taken cells, and the bonds by which nodes carry their ends.
class SpaceParticles final : public ParticlePart<3> {
public:
  explicit SpaceParticles(const SpaceModel& space) : ParticlePart<3>(space, *space.bonds, space.carried), space_(space)
  {}

  void add_names(std::vector<field::RowName>& names) const override
  {
    for (const pd::Particle& p : space_.particles) names.push_back(name(static_cast<std::size_t>(p.patch), p.site));
  }
  void add_numbers(std::vector<PetscInt>& first) const override
  {
    for (const couple::SpaceShape& shape : space_.plan.shapes)
      first.push_back(first.back() + static_cast<PetscInt>(shape.where.active.size()));
  }
  std::string described() const override
  {
    std::string text;
    for (const couple::SpaceShape& shape : space_.plan.shapes)
      text += fmt::format("{} particles of {} = ", shape.where.active.size(), shape.of->name) +
              line_of<3>(shape.where.lattice, space_.space->stencil->half.size());
    return text;
  }
  bool carries_bonds() const override { return carried_ != nullptr; }
  std::vector<std::uint64_t> broken_carried() const override { return carried_->broken(); }
  void break_bonds(const BrokenBonds& broken) override
  {
    ParticlePart<3>::break_bonds(broken);
    std::vector<BrokenCarried<3, geom::SpaceNames>::Lattice> lattices;
    for (const couple::SpaceShape& shape : space_.plan.shapes)
      lattices.push_back({shape.names, *space_.space->stencil});
    const BrokenCarried<3, geom::SpaceNames> parted(std::move(lattices));
    if (broken.changed && broken.carried) parted.break_joined(bonds_, *broken.carried);
    carried_->set_broken(broken.changed ? parted.keys(*carried_, broken) : *broken.carried);
  }

  std::vector<SeenParticle> seen() const override
  {
    const couple::ParticleDamage all = damage();
    std::vector<SeenParticle> seen;
    for (std::size_t k = 0; k < space_.particles.size(); ++k) {
      const pd::Particle& particle = space_.particles[k];
      const couple::SpaceShape& shape = space_.plan.shapes[static_cast<std::size_t>(particle.patch)];
      const Site<3> site = shape.where.active.site(particle.site);
      seen.push_back({shape.body,
                      shape.body,
                      {site[0], site[1]},
                      all.damage[k],
                      all.precrack[k],
                      particle.x,
                      shape.where.lattice.dx});
    }
    return seen;
  }
  /// What may be particles one day: cells that stay do not part.
  void count_sites(Index body, std::int64_t, std::size_t axis,
                   std::map<std::int64_t, std::int64_t>& columns) const override
  {
    const mpm::Body<3>& of = space_.space->points.bodies[static_cast<std::size_t>(body)];
    const Index ratio = of.material.ratio;
    const auto count = [&](const Site<3>& cell) {
      for (Index k = 0; k < ratio; ++k) columns[cell[axis] * ratio + k] += ratio * ratio;
    };
    for (Index c = 0; c < space_.mesh->owned_cells(); ++c) {
      const auto& column = space_.space->points.cells[static_cast<std::size_t>(space_.mesh->natural_cell(c))];
      if (column.body != body) continue;
      for (const Index layer : space_.space->points.cell_layers(column))
        if (const Site<3> at{column.at[0], column.at[1], layer};
            space_.space->why_stays({body, at}) == SpaceBodies::kFree)
          count(at);
    }
  }

private:
  field::RowName name(std::size_t patch, Index site) const override
  {
    const couple::SpaceShape& shape = space_.plan.shapes[patch];
    return field::RowName::particle(shape.names.of(shape.where.active.site(site)));
  }
  const SpaceModel& space_;
};

/// Rows of the nodes where points meet particles, of each body that has some. Collective.
std::vector<couple::NodeRows> border_rows(const SpaceModel& space)
{
  struct Row {
    mpm::GridPlace<3> node;
    PetscInt row;
  };
  const PointRows<3>& grid = space.points->grid;
  std::vector<Row> mine;
  for (std::size_t k = 0; k < grid.nodes.size(); ++k) {
    bool border = false;
    for (Index around = 0; around < 8; ++around) {
      mpm::GridPlace<3> cell = grid.nodes[k];
      for (std::size_t d = 0; d < 3; ++d) cell.at[d] -= around >> d & 1;
      border = border || space.taken.has(cell);
    }
    if (border) mine.push_back({grid.nodes[k], grid.rows.first + static_cast<PetscInt>(k)});
  }
  std::vector<couple::NodeRows> rows(space.plan.shapes.size());
  for (const auto& [node, row] : gather_all(grid.rows.comm, mine))
    for (std::size_t p = 0; p < rows.size(); ++p)
      if (space.plan.shapes[p].body == node.body) rows[p][node.at] = row;
  return rows;
}

void add_bonds(const options::SceneOptions& options, SpaceModel& space)
{
  const pd::Stencil<3>& stencil = *space.space->stencil;
  std::vector<std::unique_ptr<pd::LatticePart<3>>> parts;
  Index row = space.system.rows.first_particle();
  for (std::size_t p = 0; p < space.plan.shapes.size(); ++p) {
    const couple::SpaceShape& shape = space.plan.shapes[p];
    std::vector<Index> sites;
    for (const pd::Particle& particle : space.particles)
      if (particle.patch == static_cast<Index>(p)) sites.push_back(particle.site);
    const Index first = row;
    row += static_cast<Index>(sites.size());
    pd::SurfaceCorrection<3> correction;
    pd::Exists<3> exists = couple::family_of(shape, couple::family_sight(stencil));
    if (space.space->sides)
      correction = pd::correct_sides(stencil, *space.space->sides, std::move(exists), nullptr);
    else if (options.pd.surface_correction != options::SurfaceCorrection::none)
      correction = pd::correct_volumes<3>(stencil, std::move(exists));
    parts.push_back(std::make_unique<pd::LatticePart<3>>(space.system.rows, shape.where, stencil, std::move(sites),
                                                         first, std::move(correction)));
  }
  couple::CouplingOptions coupling;
  coupling.kinematics = options.bond_kinematics();
  coupling.no_fail = options.fracture.no_fail;
  coupling.frame = options.frame;
  auto carried = couple::carry_bonds(space.system.rows, coupling, parts, space.plan.shapes, border_rows(space));
  space.carried = carried.get();
  space.system.terms.push_back(std::move(carried));
  auto bonds = std::make_unique<pd::BondTerm<3>>(std::move(parts), options.bond_kinematics(), false);
  space.bonds = bonds.get();
  space.system.terms.push_back(std::move(bonds));
}

/// Points and particles at the surface of bodies, of this rank.
std::vector<couple::SurfacePoint<3>> surface_of(const SpaceModel& space)
{
  const PointRows<3>& grid = space.points->grid;
  std::vector<couple::SurfacePoint<3>> points = surface_points<3>(space.points->plan, space.points->owned_cells(),
                                                                  *space.points->term, [](Index) { return true; });
  for (std::size_t k = 0; k < space.taken.particles.size(); ++k)
    add_surface_particle<3>(space.points->plan, space.taken.particles[k].body, space.taken.particles[k].site,
                            grid.rows.first + grid.rows.first_particle() + static_cast<PetscInt>(k), points);
  return points;
}

/// From here on bonds step in lane strips, watched for breaking if anything breaks.
void step_explicitly(const options::SceneOptions& options, SpaceModel& space)
{
  if (!options.fracture.active()) {
    space.bonds->step_explicitly({});
    space.carried->step_explicitly();
    return;
  }
  using Breaker = couple::StepBreaker<3>;
  space.critical_stretch.assign(space.plan.shapes.size(), critical_stretch<3>(options, *space.space->stencil));
  const couple::FractureRule rule{space.critical_stretch, options.fracture.no_fail, options.fracture.release,
                                  options.fracture.release_share, options.bond_kinematics()};
  auto breaker = std::make_unique<Breaker>(*space.bonds, space.carried, rule, Breaker::Steps::in_strips);
  space.breaker = breaker.get();
  space.system.after_step.push_back(std::move(breaker));
}
} // namespace space_body

adapt::SpaceView SpaceModel::view() const
{
  return {*system.halo,
          space->points.bodies,
          space->names,
          own_cells(),
          points->grid.nodes,
          plan.shapes,
          particles,
          *bonds,
          carried,
          [this](const mpm::GridPlace<3>& cell) {
            return space->why_stays(cell) == SpaceBodies::kFree && !taken.has(cell);
          }};
}

std::unique_ptr<SpaceModel> discretise(const options::SceneOptions& options, const SpaceBodies& bodies,
                                       const mesh::Mesh& mesh)
{
  using namespace space_body;
  auto model = std::make_unique<SpaceModel>(SpacePlan(bodies, options.pd.cells));
  SpaceModel& space = *model;
  space.space = &bodies;
  space.mesh = &mesh;
  space.body = mesh.bounds();
  judge_no_fail(options, space.body);
  space.particles = space.plan.particles(bodies, mesh);
  space.taken.has = [&space](const mpm::GridPlace<3>& cell) { return space.plan.cells.contains(cell); };
  for (const pd::Particle& p : space.particles) {
    const couple::SpaceShape& shape = space.plan.shapes[static_cast<std::size_t>(p.patch)];
    space.taken.particles.push_back({shape.body, shape.where.active.site(p.site)});
  }
  auto points = std::make_unique<SpacePoints>(bodies, mesh, space);
  space.points = points.get();
  space.parts.push_back(std::move(points));
  PointBody<3>& body = *space.points;
  field::System& system = space.system;
  system.rows = body.grid.rows;
  for (const Vector<3>& x : body.grid.place) system.coordinates.insert(system.coordinates.end(), x.begin(), x.end());
  add_points<3>(bodies.points, options.points, body);
  space.material_points = body.term->points();
  MPI_Allreduce(MPI_IN_PLACE, &space.material_points, 1, MPI_INT64_T, MPI_SUM, mesh.comm());
  add_bonds(options, space);
  space.parts.push_back(std::make_unique<SpaceParticles>(space));
  throw_bodies<3>(options.points, bodies.points, body.grid.body, system);
  add_contact<3>(
      options, touching_bodies(bodies.points), [&] { return surface_of(space); }, space);
  apply_conditions<3>(options, body);
  system.bind();
  space.bodies =
      std::make_unique<BodyBooks<3>>(system, body.rows_of_bodies(), space.touching ? space.touching->books() : nullptr);
  step_explicitly(options, space);
  space.bonds->skip_below(options.pd.skip_tolerance);
  return model;
}
} // namespace pdx::scene
