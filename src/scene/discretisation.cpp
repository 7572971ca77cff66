#include "pdx/scene/discretisation.hpp"

#include "mesh_part.hpp"
#include "particle_part.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/coarse/coarse_mesh.hpp"
#include "pdx/couple/seams.hpp"
#include "pdx/mesh/vertex_halo.hpp"
#include "pdx/scene/apply_conditions.hpp"
#include "pdx/scene/heat.hpp"
#include "pdx/scene/mixed_points.hpp"
#include "pdx/scene/support.hpp"
#include "pdx/solve/stable_step.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>

namespace pdx::scene {
namespace {
void cut_cells(mesh::Mesh& mesh, const options::SceneOptions& options, const PatchPlan& plan, Discretisation& d,
               Kept* kept)
{
  d.body = options.mesh.file.empty() ? plan.body : mesh.bounds();
  judge_no_fail(options, d.body);
  if (options.cracks.lines.empty()) return;
  d.cracks = cracks_in(options, d.body);
  if (kept) d.sets = kept->sets(mesh, d.cracks);
  if (!d.sets) d.sets = std::make_unique<xfem::EnrichedSets>(mesh, d.cracks, options.cracks.rule, options.frame);
  d.cut = &d.sets->report();
}

/// Nodes that touch an element have a row; those inside a patch have none.
void find_nodes(const mesh::Mesh& mesh, bool with_points, Discretisation& d)
{
  std::vector<std::uint8_t> active(static_cast<std::size_t>(mesh.vertices()), 0);
  for (const mesh::Use use : {mesh::Use::plain, mesh::Use::cut, mesh::Use::points})
    for (const Index c : mesh.cells(use))
      for (const Index v : mesh.cell(c)) active[static_cast<std::size_t>(v)] = 1;
  for (Index v = 0; v < mesh.owned_vertices(); ++v)
    if (active[static_cast<std::size_t>(v)]) d.nodes.push_back(v);
  if (with_points) // rows of a line of the grid follow each other
    std::ranges::sort(d.nodes, {}, [&mesh](Index v) { return mesh.natural_vertex(v); });
  d.node_rows.assign(static_cast<std::size_t>(mesh.vertices()), -1);
}

/// Of an owned row.
Vector<2> place_of(const mesh::Mesh& mesh, const Discretisation& d, Index row)
{
  const field::Rows& rows = d.system.rows;
  if (row < rows.nodes) return mesh.point(d.nodes[static_cast<std::size_t>(row)]);
  if (row < rows.first_particle()) return mesh.point(d.sets->vertices()[static_cast<std::size_t>(row - rows.nodes)]);
  return d.particles[static_cast<std::size_t>(row - rows.first_particle())].x;
}

void place_rows(const mesh::Mesh& mesh, std::span<const Index> rows, Discretisation& d)
{
  for (const Index row : rows) {
    const Vector<2> x = place_of(mesh, d, row);
    std::copy_n(x.data(), 2, d.system.coordinates.begin() + 2 * std::ptrdiff_t{row});
  }
}

/// How far around patches sites are looked at.
Index band_of(const PatchPlan& plan)
{
  Index band = 0;
  for (const auto& stencil : plan.stencils) band = std::max(band, stencil.reach + pd::family_reach<2>(stencil));
  return band;
}

void number_rows(const mesh::Mesh& mesh, const PatchPlan& plan, bool with_points, Discretisation& d, Kept* kept)
{
  if (kept)
    d.nodes = kept->nodes(mesh, d.node_rows);
  else
    find_nodes(mesh, with_points, d);
  field::System& system = d.system;
  system.rows = field::Rows::number(mesh.comm(), 2, static_cast<Index>(d.nodes.size()), d.sets ? d.sets->owned() : 0,
                                    static_cast<Index>(d.particles.size()));
  for (std::size_t k = 0; k < d.nodes.size(); ++k)
    d.node_rows[static_cast<std::size_t>(d.nodes[k])] = system.rows.first + static_cast<PetscInt>(k);
  mesh::fill_halo(mesh, MPIU_INT, 1, d.node_rows.data());
  if (d.sets) d.sets->number(system.rows.first + system.rows.nodes);
  if (kept) {
    kept->number(d, mesh, band_of(plan));
    system.coordinates = kept->coordinates();
    return place_rows(mesh, kept->rows().coming(), d);
  }
  std::vector<Index> all(static_cast<std::size_t>(system.rows.owned()));
  std::iota(all.begin(), all.end(), Index{0});
  system.coordinates.resize(2 * all.size());
  place_rows(mesh, all, d);
}

/// Behind a layer of held particles the body is meant to go on: its particles keep complete families, as the layer
/// does.
pd::Exists<2> behind_layers(const options::SceneOptions& options, const geom::Lattice<2>& lattice, pd::Exists<2> exists)
{
  std::array<bool, 4> layered{}; // left, right, bottom, top
  for (const options::BoundaryCondition& c : options.conditions)
    for (std::size_t side = 0; c.layer && side < 4; ++side)
      layered[side] = layered[side] || c.on == std::array{"left", "right", "bottom", "top"}[side];
  if (std::none_of(layered.begin(), layered.end(), [](bool yes) { return yes; })) return exists;
  return [layered, lattice, exists = std::move(exists)](const Site<2>& site) {
    for (std::size_t d = 0; d < 2; ++d)
      if ((site[d] < 0 && !layered[2 * d]) || (site[d] >= lattice.count[d] && !layered[2 * d + 1])) return exists(site);
    return true;
  };
}

/// The papers' volumes end with their ghosts; sides are those of the body whatever the scheme.
pd::SurfaceCorrection<2> correction(const options::SceneOptions& options, const PatchPlan& plan,
                                    const Discretisation& d, std::size_t patch)
{
  if (options.pd.surface_correction == options::SurfaceCorrection::none) return {};
  const bool exact = plan.sides[patch].has_value();
  const pd::Stencil<2>& stencil = plan.stencils[patch];
  const couple::Scheme scheme = exact ? couple::Scheme::energy : options.scheme;
  pd::Exists<2> exists =
      behind_layers(options, plan.shapes[patch].lattice, couple::family_of(d.around[patch], stencil, scheme));
  if (!exact) return pd::correct_volumes<2>(stencil, std::move(exists));
  return pd::correct_sides(stencil, *plan.sides[patch], std::move(exists), &d.cracks);
}

pd::BondTerm<2>::Parts make_parts(const options::SceneOptions& options, const PatchPlan& plan, const Discretisation& d,
                                  Kept* kept)
{
  pd::BondTerm<2>::Parts made;
  Index row = d.system.rows.first_particle();
  for (std::size_t p = 0; p < plan.shapes.size(); ++p) {
    pd::SurfaceCorrection<2> corrected = in_regions(options, plan.stencils[p], correction(options, plan, d, p));
    made.laid.emplace_back();
    if (auto part = kept ? kept->part(p, made.laid.back()) : nullptr) {
      if (const auto& strip = made.laid.back().strip) strip->move_rows(row - part->first_row());
      part->move_rows(d.system.rows, row, std::move(corrected));
      made.parts.push_back(std::move(part));
    } else {
      std::vector<Index> sites;
      const auto of = std::ranges::equal_range(d.particles, static_cast<Index>(p), {}, &pd::Particle::patch);
      for (const pd::Particle& particle : of) sites.push_back(particle.site);
      made.parts.push_back(std::make_unique<pd::LatticePart<2>>(
          d.system.rows, geom::ActiveLattice<2>{plan.shapes[p].lattice, plan.shapes[p].active}, plan.stencils[p],
          std::move(sites), row, std::move(corrected), options.regions));
      made.parts.back()->scatter(options.fracture.scatter, plan.shapes[p].names.first);
    }
    row += static_cast<Index>(made.parts.back()->sites().size());
  }
  return made;
}

std::vector<std::size_t> numbers_from_1(std::vector<std::size_t> numbers)
{
  for (std::size_t& number : numbers) ++number;
  return numbers;
}

/// Bonds are made to be finer than the elements that carry their ends: beyond that uniform strain is no longer exact.
void refuse_coarse_patches(const options::SceneOptions& options, const PatchPlan& plan, const Discretisation& d)
{
  for (std::size_t p = 0; p < d.around.size(); ++p) {
    const std::size_t first = plan.entries[p][0];
    if (const double dx = d.around[p].shape().lattice.dx, h = d.around[p].shortest_edge(); dx > 1.000001 * h)
      throw UserError(fmt::format("-pd_spacing is {}: must be at most the {:.6g} m of the elements beside patch {}",
                                  options.pd.spacing_of(first), h, first + 1));
  }
}

/// Ghosts stand for one uninterrupted outside per bond.
void refuse_other_shapes(const options::SceneOptions& options, const PatchPlan& plan)
{
  if (options.scheme == couple::Scheme::energy || options.scheme == couple::Scheme::handshake) return;
  for (std::size_t p = 0; p < plan.shapes.size(); ++p)
    if (!plan.shapes[p].active.is_box())
      throw UserError(fmt::format("{} needs boxes apart, but {} of -pd_patches make up a patch of another "
                                  "shape: use energy, or move the boxes apart",
                                  couple::option_of(options.scheme), fmt::join(numbers_from_1(plan.entries[p]), ", ")));
}

/// A toughness tells when bonds break.
void add_fracture(const options::SceneOptions& options, const PatchPlan& plan, Discretisation& d)
{
  const options::FractureOptions& f = options.fracture;
  if (!f.active()) return;
  for (const auto& stencil : plan.stencils) d.critical_stretch.push_back(critical_stretch<2>(options, stencil));
  const couple::FractureRule rule{d.critical_stretch, f.no_fail, f.release, f.release_share, options.bond_kinematics()};
  if (options.time.dynamic()) {
    using Steps = couple::StepBreaker<2>::Steps;
    const bool strips = options.time.analysis == options::Analysis::explicit_dynamics;
    auto breaker = std::make_unique<couple::StepBreaker<2>>(*d.bonds, d.carried, rule,
                                                            strips ? Steps::in_strips : Steps::as_terms);
    d.breaker = breaker.get();
    d.system.after_step.push_back(std::move(breaker));
    return;
  }
  d.bonds_at_start = d.bonds->bonds() + (d.carried ? d.carried->bonds() : 0);
  MPI_Allreduce(MPI_IN_PLACE, &d.bonds_at_start, 1, MPI_INT64_T, MPI_SUM, d.system.rows.comm);
  auto fracture = std::make_unique<couple::Fracture>(*d.bonds, d.carried, rule);
  d.fracture = fracture.get();
  d.system.after.push_back(std::move(fracture));
}

/// Meshes from a file may be parted where a patch lies.
crack::CrackSet seams_of(const mesh::Mesh& mesh, const options::SceneOptions& options, const PatchPlan& plan)
{
  if (options.mesh.file.empty() || options.points.any()) return {};
  double reach = 0.0;
  for (const auto& stencil : plan.stencils) reach = std::max(reach, static_cast<double>(stencil.reach));
  try {
    return couple::find_seams(mesh, plan.shapes, options.scheme == couple::Scheme::energy ? 0.0 : reach);
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-mesh_file {}: where the mesh is parted under a patch, bonds cannot follow ({}): move "
                                "the patch, or mend the mesh",
                                options.mesh.file, wrong.what()));
  }
}

void add_peridynamics(const mesh::Mesh& mesh, const options::SceneOptions& options, const PatchPlan& plan,
                      Discretisation& d, bool assembled, Kept* kept)
{
  refuse_other_shapes(options, plan);
  d.seams = seams_of(mesh, options, plan);
  d.around =
      couple::Surroundings::survey(mesh, plan.shapes, band_of(plan), d.node_rows, d.sets.get(),
                                   d.seams.empty() ? nullptr : &d.seams, options.scheme != couple::Scheme::energy,
                                   kept ? kept->around() : std::vector<std::optional<couple::Surroundings>>{});
  refuse_coarse_patches(options, plan, d);
  auto made = make_parts(options, plan, d, kept);
  const auto& parts = made.parts;
  if (d.elements || d.cut_elements || d.points) {
    const couple::CouplingOptions coupling{options.scheme,
                                           options.bond_kinematics(),
                                           d.cracks.empty() ? nullptr : &d.cracks,
                                           d.seams.empty() ? nullptr : &d.seams,
                                           options.fracture.no_fail,
                                           options.face_mass ? options.elastic.density : 0.0,
                                           options.frame,
                                           options.regions.get()};
    auto carried =
        couple::carry_bonds(d.system.rows, coupling, parts, d.around, kept ? kept->families() : couple::KeptFamilies{});
    d.carried = carried.get();
    d.system.terms.push_back(std::move(carried));
    if (options.scheme != couple::Scheme::energy) d.ghosts = couple::count_ghosts(d.around, parts);
  }
  auto bonds = kept ? std::make_unique<pd::BondTerm<2>>(std::move(made), options.bond_kinematics())
                    : std::make_unique<pd::BondTerm<2>>(std::move(made.parts), options.bond_kinematics(), assembled);
  d.bonds = bonds.get();
  d.system.terms.push_back(std::move(bonds));
  for (const crack::CrackSet* cracks : {&d.cracks, &d.seams})
    if (!cracks->empty()) d.bonds->cut(*cracks);
}

/// Null where elements are of one solid: they stay in one sweep.
const law::Regions* laws_of(const options::SceneOptions& options)
{
  return options.regions && !options.regions->one_elastic() ? options.regions.get() : nullptr;
}

void add_elements(const mesh::Mesh& mesh, const options::SceneOptions& options, const fem::CornerAreas* areas,
                  Discretisation& d, Kept* kept)
{
  if (any_rank(mesh.comm(), !mesh.cells(mesh::Use::plain).empty())) {
    std::unique_ptr<fem::ElasticTerm> elements;
    if (kept) elements = kept->elements(mesh, d.node_rows);
    if (!elements)
      elements = std::make_unique<fem::ElasticTerm>(mesh, options.elastic, options.element_kinematics(), d.node_rows,
                                                    laws_of(options), areas);
    d.elements = elements.get();
    d.system.terms.push_back(std::move(elements));
  }
  if (any_rank(mesh.comm(), !mesh.cells(mesh::Use::cut).empty())) {
    auto cut = std::make_unique<xfem::EnrichedTerm>(mesh, options.elastic, options.element_kinematics(), d.node_rows,
                                                    *d.sets, laws_of(options));
    d.cut_elements = cut.get();
    d.system.terms.push_back(std::move(cut));
  }
}
} // namespace

std::unique_ptr<Discretisation> discretise(mesh::Mesh& mesh, const options::SceneOptions& options,
                                           const PatchPlan& plan, std::vector<pd::Particle> particles, bool assembled,
                                           const PointPlan<2>* points, const fem::CornerAreas* areas, Kept* kept)
{
  auto result = std::make_unique<Discretisation>();
  Discretisation& d = *result;
  d.particles = std::move(particles);
  d.patch_plan = &plan;
  cut_cells(mesh, options, plan, d, kept);
  number_rows(mesh, plan, points != nullptr, d, kept);
  field::System& system = d.system;
  system.scale = options.elastic.young * options.elastic.thickness;
  for (std::size_t k = 1; options.regions && k < options.regions->count(); ++k)
    system.scale = std::max(system.scale, options.regions->elastic(k).young * options.regions->elastic(k).thickness);
  add_elements(mesh, options, areas, d, kept);
  if (points) add_points(mesh, options, *points, d);
  if (!plan.shapes.empty() || options.converts()) add_peridynamics(mesh, options, plan, d, assembled, kept);
  if (points) add_bodies(mesh, options, d);
  apply_conditions(mesh, options, plan, d);

  const std::span<const std::unique_ptr<pd::LatticePart<2>>> parts =
      d.bonds ? std::span(d.bonds->parts()) : std::span<const std::unique_ptr<pd::LatticePart<2>>>();
  d.node_field = std::make_unique<couple::NodeField>(mesh, d.node_rows, parts);
  system.bind(d.node_field->needed_rows());
  system.swelling = swelling_of(options);
  d.node_field->bind(*system.halo);
  if (kept) {
    kept->give_mass(system);
    solve::know_mass(system, kept->near(d, mesh));
  }
  d.parts.push_back(mesh_part(mesh, d));
  if (d.bonds) d.parts.push_back(patch_part(mesh, d));
  if (points) {
    keep_books(d);
    d.parts.push_back(mixed_part(mesh, d));
  }
  if (!options.time.dynamic()) {
    const couple::JoinedModels models{mesh, d.node_rows, d.sets.get(), parts, d.carried};
    d.loose_parts = std::make_unique<couple::LooseParts>(models, system);
    require_support(*d.loose_parts, options.frame);
  }
  if (d.bonds) {
    add_fracture(options, plan, d);
    if (options.time.analysis == options::Analysis::explicit_dynamics && !d.breaker) {
      d.bonds->step_explicitly({});
      if (d.carried) d.carried->step_explicitly();
    }
    d.bonds->skip_below(options.pd.skip_tolerance);
  }
  if (assembled || !d.bonds || options.time.dynamic()) return result;

  coarse::FineRows fine{d.node_rows, d.sets.get(), d.bonds->parts(), d.around};
  fine.breakable = d.fracture || !d.cracks.empty() || !d.seams.empty();
  system.coarse = std::make_unique<coarse::CoarseMesh>(
      fem::ElasticBody{mesh, options.elastic, options.element_kinematics(), laws_of(options)}, *d.node_field, fine,
      system);
  return result;
}

adapt::SceneView Discretisation::view(const mesh::Mesh& mesh) const
{
  return {mesh, node_rows, sets.get(), around, *bonds, carried, *system.halo, particles, side_held, stays};
}

std::vector<double> Discretisation::vertex_displacement(Vec u) const
{
  std::vector<double> local;
  system.halo->gather(u, local);
  return node_field->displacement(local);
}
} // namespace pdx::scene
