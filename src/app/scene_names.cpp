#include "pdx/app/scene_names.hpp"

#include "pdx/app/cloud_body.hpp"
#include "pdx/app/solid.hpp"

namespace pdx::app {
namespace {
const geom::Lattice<3>& lattice_of(const Solid& solid) { return solid.bonds->parts()[0]->lattice(); }
Index middle_of(const geom::Lattice<3>& lattice) { return lattice.count[2] / 2; }

/// Owned enriched sets in order of rows.
void add_sets(const mesh::Mesh& mesh, const Discretisation& d, std::vector<field::RowName>& names)
{
  if (!d.sets) return;
  PetscInt row = d.system.rows.first + d.system.rows.nodes;
  for (const Index v : d.sets->vertices()) {
    for (const xfem::EnrichedSet& set : d.sets->of(v))
      if (set.row == row) names.push_back(field::RowName::set(mesh.natural_vertex(v), set.crack));
    ++row;
  }
}
} // namespace

SceneNames::SceneNames(const Standing& scene) : scene_(scene)
{
  if (scene.d) {
    for (const Index v : scene.d->nodes) rows_.push_back(field::RowName::node(scene.mesh->natural_vertex(v)));
    add_sets(*scene.mesh, *scene.d, rows_);
  }
  for (const pd::Particle& p : scene.model->particles) rows_.push_back(particle(p.patch, p.site));
}

std::span<const field::RowName> SceneNames::particles() const
{
  return std::span(rows_).last(static_cast<std::size_t>(scene_.model->system.rows.particles));
}

field::RowName SceneNames::particle(Index patch, Index site) const
{
  if (!scene_.plan) return field::RowName::particle(static_cast<std::uint64_t>(site));
  const couple::PatchShape& shape = scene_.plan->shapes[static_cast<std::size_t>(patch)];
  return field::RowName::particle(shape.names.of(shape.active.site(site)));
}

field::RowName SceneNames::arrival(Index patch, Index site) const
{
  if (!scene_.solid) return particle(patch, site);
  const geom::Lattice<3>& lattice = lattice_of(*scene_.solid);
  const Index column = site % lattice.count[0], row = site / lattice.count[0];
  return particle(patch, static_cast<Index>(lattice.number({column, row, middle_of(lattice)})));
}

std::optional<SceneNames::Place> SceneNames::arrival_at(field::RowName name) const
{
  if (name.kind() != field::RowName::Kind::particle) return std::nullopt;
  if (scene_.solid) {
    const geom::Lattice<3>& lattice = lattice_of(*scene_.solid);
    if (name.key() >= static_cast<std::uint64_t>(lattice.total())) return std::nullopt;
    const Site<3> site = lattice.site(static_cast<Index>(name.key()));
    if (site[2] != middle_of(lattice)) return std::nullopt;
    return Place{0, site[0] + lattice.count[0] * site[1]};
  }
  for (std::size_t p = 0; scene_.plan && p < scene_.plan->shapes.size(); ++p) {
    const couple::PatchShape& shape = scene_.plan->shapes[p];
    const auto site = shape.names.site(name.key());
    if (site && shape.active.has(*site))
      return Place{static_cast<Index>(p), static_cast<Index>(shape.active.place(*site))};
  }
  return std::nullopt;
}

bool SceneNames::is_watched(std::size_t k) const
{
  if (!scene_.solid) return true;
  const geom::Lattice<3>& lattice = lattice_of(*scene_.solid);
  return lattice.site(scene_.solid->particles[k].site)[2] == middle_of(lattice);
}
} // namespace pdx::app
