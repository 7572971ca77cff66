#include "pdx/record/output_blocks.hpp"

#include "pdx/xfem/cut_output.hpp"

#include "pdx/fem/stress_recovery.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <algorithm>

namespace pdx::record {
namespace {
template <int Dim> std::array<double, 3> padded(const double* x)
{
  std::array<double, 3> all{};
  std::copy_n(x, Dim, all.begin());
  return all;
}

template <int Dim> field::OutputField vector_field(const char* name, std::span<const double> blocks, std::size_t count)
{
  field::OutputField f{name, field::Rank::vector, false, false, {}};
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = padded<Dim>(&blocks[Dim * k]);
    f.values.insert(f.values.end(), value.begin(), value.end());
  }
  return f;
}

template <int Dim> field::OutputField displacement_field(std::span<const double> blocks, std::size_t count)
{
  return vector_field<Dim>("displacement [m]", blocks, count);
}

field::OutputField stress_field(const std::vector<double>& stress)
{
  field::OutputField f{"stress [Pa]", field::Rank::tensor, false, false, {}};
  for (std::size_t k = 0; k + 2 < stress.size(); k += 3) // xx, xy, xz, yy, yz, zz
    f.values.insert(f.values.end(), {stress[k], stress[k + 2], 0.0, stress[k + 1], 0.0, 0.0});
  return f;
}

/// File numbers of all local vertices: rank by rank, owned vertices in order.
std::vector<PetscInt> file_numbers(const mesh::Mesh& mesh)
{
  const field::Rows rows = field::Rows::number(mesh.comm(), 1, mesh.owned_vertices(), 0, 0);
  std::vector<PetscInt> numbers(static_cast<std::size_t>(mesh.vertices()));
  for (Index v = 0; v < mesh.owned_vertices(); ++v) numbers[static_cast<std::size_t>(v)] = rows.first + v;
  mesh::fill_halo(mesh, MPIU_INT, 1, numbers.data());
  return numbers;
}

field::OutputBlock mesh_block(const mesh::Mesh& mesh, const options::SceneOptions& options,
                              std::span<const double> displacement, const std::vector<double>& relative_percent)
{
  field::OutputBlock block;
  block.name = "mesh";
  block.quadrilaterals = true;
  const auto owned = static_cast<std::size_t>(mesh.owned_vertices());
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    block.points.insert(block.points.end(), {mesh.point(v)[0], mesh.point(v)[1], 0.0});
    block.natural_point.push_back(mesh.natural_vertex(v));
  }
  const std::vector<PetscInt> numbers = file_numbers(mesh);
  field::OutputField use{"use", field::Rank::scalar, true, true, {}}, rank{"rank", field::Rank::scalar, true, true, {}};
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    for (const Index v : mesh.cell(c)) block.cells.push_back(numbers[static_cast<std::size_t>(v)]);
    use.values.push_back(static_cast<double>(mesh.use(c)));
    rank.values.push_back(mesh.cell_owner(c));
  }
  block.fields.push_back(displacement_field<2>(displacement, owned));
  block.fields.push_back(stress_field(
      fem::nodal_stress({mesh, options.elastic, options.element_kinematics(), options.regions.get()}, displacement)));
  if (options.post.reference_fe)
    block.fields.push_back({"relative_error_percent [%]", field::Rank::scalar, false, false, relative_percent});
  block.fields.push_back(std::move(use));
  block.fields.push_back(std::move(rank));
  if (options.regions) {
    field::OutputField region{"region", field::Rank::scalar, true, true, {}};
    for (Index c = 0; c < mesh.owned_cells(); ++c) region.values.push_back(options.regions->at(mesh.centroid(c)));
    block.fields.push_back(std::move(region));
  }
  return block;
}

/// The particles of a scene, in the plane or in space.
template <int Dim> struct ParticleScene {
  const field::System& system;
  const pd::BondTerm<Dim>& bonds;
  const couple::CarriedBonds<Dim>* carried;
  std::span<const pd::Particle> particles;
  bool damaged; ///< bonds may be missing
};

/// 2 held, 1 some bond of a full family is missing or carried, 0 inner.
template <int Dim> double kind_of(const ParticleScene<Dim>& scene, std::size_t k)
{
  const std::size_t row = static_cast<std::size_t>(scene.system.rows.first_particle()) + k;
  for (std::size_t a = 0; a < Dim; ++a)
    if (scene.system.held[Dim * row + a]) return 2.0;
  const pd::Particle& particle = scene.particles[k];
  const pd::LatticePart<Dim>& part = *scene.bonds.parts()[static_cast<std::size_t>(particle.patch)];
  return part.deep(part.site(particle.site)) ? 0.0 : 1.0;
}

void push_damage(const options::SceneOptions& options, couple::ParticleDamage damage, field::OutputBlock& block)
{
  for (std::size_t k = 0; options.post.precrack_as_damage && k < damage.damage.size(); ++k)
    damage.damage[k] += damage.precrack[k];
  block.fields.push_back({"damage [-]", field::Rank::scalar, false, false, std::move(damage.damage)});
  block.fields.push_back({"precrack [-]", field::Rank::scalar, false, false, std::move(damage.precrack)});
}

template <int Dim>
void add_damage(const options::SceneOptions& options, const ParticleScene<Dim>& scene, field::OutputBlock& block)
{
  push_damage(options, couple::particle_damage<Dim>(scene.system.rows, scene.bonds, scene.carried), block);
}

/// @param density strain energy density per owned row [J/m^3]
template <int Dim>
field::OutputBlock particle_block(const options::SceneOptions& options, const ParticleScene<Dim>& scene,
                                  std::span<const double> local, std::span<const double> density)
{
  field::OutputBlock block;
  block.name = "particles";
  const auto& parts = scene.bonds.parts();
  std::vector<Index> first(parts.size() + 1, 0); // natural numbers: patch after patch
  for (std::size_t p = 0; p < parts.size(); ++p)
    first[p + 1] = first[p] + static_cast<Index>(parts[p]->active().size());
  int rank = 0;
  MPI_Comm_rank(scene.system.rows.comm, &rank);
  const auto begin = static_cast<std::size_t>(scene.system.rows.first_particle());
  field::OutputField energy{"strain_energy_density [J/m^3]", field::Rank::scalar, false, false, {}};
  field::OutputField kind{"kind", field::Rank::scalar, false, true, {}},
      owner{"rank", field::Rank::scalar, false, true, {}}, patch{"patch", field::Rank::scalar, false, true, {}},
      region{"region", field::Rank::scalar, false, true, {}};
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const pd::Particle& particle = scene.particles[k];
    const auto p = static_cast<std::size_t>(particle.patch);
    const auto x = padded<Dim>(parts[p]->lattice().point(parts[p]->site(particle.site)).data());
    block.points.insert(block.points.end(), x.begin(), x.end());
    block.natural_point.push_back(first[p] + particle.site);
    energy.values.push_back(density[begin + k]);
    kind.values.push_back(kind_of<Dim>(scene, k));
    owner.values.push_back(rank);
    patch.values.push_back(particle.patch);
    if (options.regions) region.values.push_back(options.regions->at({x[0], x[1]}));
  }
  block.fields.push_back(displacement_field<Dim>(local.subspan(Dim * begin), scene.particles.size()));
  if (scene.damaged) add_damage<Dim>(options, scene, block);
  block.fields.push_back(std::move(energy));
  block.fields.push_back(std::move(kind));
  block.fields.push_back(std::move(owner));
  block.fields.push_back(std::move(patch));
  if (options.regions) block.fields.push_back(std::move(region));
  return block;
}
} // namespace

namespace {
/// Displacement and velocity of a cloud.
template <int Dim>
void push_motion(const scene::CloudModel& cloud, std::span<const double> local, std::span<const double> velocity,
                 field::OutputBlock& block)
{
  const std::size_t count = cloud.particles.size();
  block.fields.push_back(vector_field<Dim>("displacement [m]", local, count));
  block.fields.push_back(vector_field<Dim>("velocity [m/s]", velocity, count));
}
} // namespace

std::vector<field::OutputBlock> cloud_blocks(const options::SceneOptions& options, const scene::CloudModel& cloud,
                                             Vec u, std::span<const double> velocity)
{
  std::vector<double> local;
  cloud.system.halo->gather(u, local);
  field::OutputBlock block;
  block.name = "particles";
  block.points = cloud.positions();
  for (const pd::Particle& particle : cloud.particles) block.natural_point.push_back(particle.site);
  if (cloud.system.rows.dim == 2)
    push_motion<2>(cloud, local, velocity, block);
  else
    push_motion<3>(cloud, local, velocity, block);
  if (cloud.breaker || !cloud.cracks.empty()) {
    couple::ParticleDamage damage;
    for (const pd::BondedVolume& volume : cloud.bonded_volume()) {
      damage.damage.push_back(pd::damage(volume));
      damage.precrack.push_back(pd::precrack_share(volume));
    }
    push_damage(options, std::move(damage), block);
  }
  int rank = 0;
  MPI_Comm_rank(cloud.system.rows.comm, &rank);
  block.fields.push_back({"volume [m^3]", field::Rank::scalar, false, false, cloud.volumes()});
  block.fields.push_back({"set", field::Rank::scalar, false, true, {cloud.sets.begin(), cloud.sets.end()}});
  block.fields.push_back({"rank", field::Rank::scalar, false, true,
                          std::vector<double>(cloud.particles.size(), static_cast<double>(rank))});
  return {block};
}

std::vector<field::OutputBlock> solid_blocks(const options::SceneOptions& options, const scene::Solid& solid, Vec u)
{
  std::vector<double> local;
  solid.system.halo->gather(u, local);
  const ParticleScene<3> scene{solid.system, *solid.bonds, nullptr, solid.particles,
                               solid.breaker || !solid.cracks.empty()};
  return {particle_block<3>(options, scene, local, solid.bonds->energy_density(local))};
}

std::vector<field::OutputBlock> output_blocks(const mesh::Mesh& mesh, const options::SceneOptions& options,
                                              const scene::Discretisation& d, Vec u,
                                              const std::vector<double>& relative_percent)
{
  std::vector<double> local;
  d.system.halo->gather(u, local);
  std::vector<field::OutputBlock> blocks;
  blocks.push_back(mesh_block(mesh, options, d.node_field->displacement(local), relative_percent));
  if (d.cut_elements) blocks.push_back(xfem::cut_block(mesh, *d.sets, d.node_rows, *d.system.halo, local));
  if (!d.bonds) return blocks;
  const ParticleScene<2> scene{d.system, *d.bonds, d.carried, d.particles,
                               d.fracture || d.breaker || !d.cracks.empty()};
  blocks.push_back(particle_block<2>(options, scene, local, d.energy_density(local)));
  return blocks;
}

void add_velocity(const scene::Discretisation& d, std::span<const double> velocity,
                  std::vector<field::OutputBlock>& blocks)
{
  const auto first = 2 * static_cast<std::size_t>(d.system.rows.first_particle());
  for (field::OutputBlock& block : blocks)
    if (block.name == "particles")
      block.fields.push_back(vector_field<2>("velocity [m/s]", velocity.subspan(first), d.particles.size()));
}
} // namespace pdx::record
