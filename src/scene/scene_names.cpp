#include "pdx/scene/scene_names.hpp"

#include "pdx/scene/cloud_body.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/solid.hpp"

namespace pdx::scene {
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
  if (scene.points) rows_ = scene.points->node_names;
  add_particles();
}

/// Sites that follow each other in a run have names that do.
void SceneNames::add_particles()
{
  const std::span<const pd::Particle> particles = scene_.model->particles;
  rows_.reserve(rows_.size() + particles.size());
  Index left = 0;         // of the run, behind the particle before
  std::uint64_t step = 1; // from one name of the run to the next
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const auto& [patch, site, cell, x] = particles[k];
    if (left > 0 && patch == particles[k - 1].patch && site == particles[k - 1].site + 1) {
      rows_.push_back(field::RowName::particle(rows_.back().key() + step));
      --left;
      continue;
    }
    rows_.push_back(particle(patch, site));
    if (!scene_.plan) continue;
    const couple::PatchShape& shape = scene_.plan->shapes[static_cast<std::size_t>(patch)];
    const Site<2> at = shape.active.site(site);
    left = shape.active.end_of_run(at) - at[0] - 1;
    step = static_cast<std::uint64_t>(shape.names.lattices);
  }
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

bool SceneNames::is_watched(std::size_t k) const
{
  if (!scene_.solid) return true;
  const geom::Lattice<3>& lattice = lattice_of(*scene_.solid);
  return lattice.site(scene_.solid->particles[k].site)[2] == middle_of(lattice);
}
} // namespace pdx::scene
