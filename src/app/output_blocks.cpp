#include "pdx/app/output_blocks.hpp"

#include "pdx/xfem/cut_output.hpp"

#include "pdx/fem/stress_recovery.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <algorithm>

namespace pdx::app {
namespace {
field::OutputField displacement_field(std::span<const double> pairs, std::size_t count)
{
  field::OutputField f{"displacement [m]", field::Rank::vector, false, false, {}};
  for (std::size_t k = 0; k < count; ++k) f.values.insert(f.values.end(), {pairs[2 * k], pairs[2 * k + 1], 0.0});
  return f;
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

field::OutputBlock mesh_block(const mesh::Mesh& mesh, const SceneOptions& options, std::span<const double> displacement,
                              const std::vector<double>& relative_percent)
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
  block.fields.push_back(displacement_field(displacement, owned));
  block.fields.push_back(
      stress_field(fem::nodal_stress({mesh, options.elastic, options.element_kinematics()}, displacement)));
  if (options.post.reference_fe)
    block.fields.push_back({"relative_error_percent [%]", field::Rank::scalar, false, false, relative_percent});
  block.fields.push_back(std::move(use));
  block.fields.push_back(std::move(rank));
  return block;
}

/// 2 held, 1 some bond of a full family is missing or carried, 0 inner.
double kind_of(const Discretisation& d, const PatchPlan& plan, std::size_t k)
{
  const auto row = static_cast<std::size_t>(d.system.rows.first_particle()) + k;
  if (d.system.held[2 * row] || d.system.held[2 * row + 1]) return 2.0;
  const pd::Particle& particle = d.particles[k];
  const auto p = static_cast<std::size_t>(particle.patch);
  const auto& lattice = plan.shapes[p].lattice;
  const Site<2> site = lattice.site(particle.site);
  const Index reach = plan.stencils[p].reach;
  for (std::size_t a = 0; a < 2; ++a)
    if (site[a] < reach || site[a] >= lattice.count[a] - reach) return 1.0;
  return 0.0;
}

void add_damage(const SceneOptions& options, const Discretisation& d, field::OutputBlock& block)
{
  couple::ParticleDamage damage = couple::particle_damage(d.system.rows, *d.bonds, d.carried);
  for (std::size_t k = 0; options.post.precrack_as_damage && k < damage.damage.size(); ++k)
    damage.damage[k] += damage.precrack[k];
  block.fields.push_back({"damage [-]", field::Rank::scalar, false, false, std::move(damage.damage)});
  block.fields.push_back({"precrack [-]", field::Rank::scalar, false, false, std::move(damage.precrack)});
}

field::OutputBlock particle_block(const SceneOptions& options, const PatchPlan& plan, const Discretisation& d,
                                  std::span<const double> local)
{
  field::OutputBlock block;
  block.name = "particles";
  std::vector<Index> first(plan.shapes.size() + 1, 0); // natural numbers: patch after patch
  for (std::size_t p = 0; p < plan.shapes.size(); ++p)
    first[p + 1] = first[p] + static_cast<Index>(plan.shapes[p].lattice.total());
  int rank = 0;
  MPI_Comm_rank(d.system.rows.comm, &rank);
  const auto begin = static_cast<std::size_t>(d.system.rows.first_particle());
  const std::vector<double> density = d.energy_density(local);
  field::OutputField energy{"strain_energy_density [J/m^3]", field::Rank::scalar, false, false, {}};
  field::OutputField kind{"kind", field::Rank::scalar, false, true, {}},
      owner{"rank", field::Rank::scalar, false, true, {}}, patch{"patch", field::Rank::scalar, false, true, {}};
  for (std::size_t k = 0; k < d.particles.size(); ++k) {
    const pd::Particle& particle = d.particles[k];
    block.points.insert(block.points.end(), {particle.x[0], particle.x[1], 0.0});
    block.natural_point.push_back(first[static_cast<std::size_t>(particle.patch)] + particle.site);
    energy.values.push_back(density[begin + k]);
    kind.values.push_back(kind_of(d, plan, k));
    owner.values.push_back(rank);
    patch.values.push_back(particle.patch);
  }
  block.fields.push_back(displacement_field(local.subspan(2 * begin), d.particles.size()));
  if (d.fracture || !d.cracks.empty()) add_damage(options, d, block);
  block.fields.push_back(std::move(energy));
  block.fields.push_back(std::move(kind));
  block.fields.push_back(std::move(owner));
  block.fields.push_back(std::move(patch));
  return block;
}
} // namespace

std::vector<field::OutputBlock> output_blocks(const mesh::Mesh& mesh, const SceneOptions& options,
                                              const PatchPlan& plan, const Discretisation& d, Vec u,
                                              const std::vector<double>& relative_percent)
{
  std::vector<double> local;
  d.system.halo->gather(u, local);
  std::vector<field::OutputBlock> blocks;
  blocks.push_back(mesh_block(mesh, options, d.node_field->displacement(local), relative_percent));
  if (d.cut_elements) blocks.push_back(xfem::cut_block(mesh, *d.sets, d.node_rows, *d.system.halo, local));
  if (d.bonds) blocks.push_back(particle_block(options, plan, d, local));
  return blocks;
}
} // namespace pdx::app
