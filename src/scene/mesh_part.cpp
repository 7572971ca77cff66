#include "mesh_part.hpp"

#include "output_fields.hpp"
#include "pdx/fem/stress_recovery.hpp"
#include "pdx/mesh/vertex_halo.hpp"
#include "pdx/scene/heat.hpp"
#include "pdx/xfem/cut_output.hpp"

#include <algorithm>

namespace pdx::scene {
namespace {
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

class MeshPart final : public Part {
public:
  MeshPart(const mesh::Mesh& mesh, const Discretisation& d) : mesh_(mesh), d_(d) {}

  void add_names(std::vector<field::RowName>& names) const override
  {
    for (const Index v : d_.nodes) names.push_back(field::RowName::node(mesh_.natural_vertex(v)));
    if (!d_.sets) return;
    PetscInt row = d_.system.rows.first + d_.system.rows.nodes;
    for (const Index v : d_.sets->vertices()) {
      for (const xfem::EnrichedSet& set : d_.sets->of(v))
        if (set.row == row) names.push_back(field::RowName::set(mesh_.natural_vertex(v), set.crack));
      ++row;
    }
  }

  field::RowName row_name(Index row) const override
  {
    const field::Rows& rows = d_.system.rows;
    if (row < rows.nodes) return field::RowName::node(mesh_.natural_vertex(d_.nodes[static_cast<std::size_t>(row)]));
    if (row >= rows.first_particle()) return {};
    const Index v = d_.sets->vertices()[static_cast<std::size_t>(row - rows.nodes)];
    const auto of = std::ranges::find(d_.sets->of(v), rows.first + row, &xfem::EnrichedSet::row);
    return field::RowName::set(mesh_.natural_vertex(v), of->crack);
  }

  void add_energies(std::span<const double> local, post::Energies& mine) const override
  {
    if (d_.elements) mine.elements += d_.elements->energy(local);
    if (d_.cut_elements) mine.elements += d_.cut_elements->energy(local);
  }

  /// The mesh with displacement, stress, cell use and rank; and what cracks leave of cells.
  void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const override
  {
    blocks.push_back(mesh_block(now, d_.node_field->displacement(now.local)));
    if (d_.cut_elements) blocks.push_back(xfem::cut_block(mesh_, *d_.sets, d_.node_rows, *d_.system.halo, now.local));
  }

  bool works_in(const field::Term& term) const override { return &term == d_.elements || &term == d_.cut_elements; }
  void add_shares(std::vector<double>& cells) const override
  {
    for (Index c = 0; c < mesh_.owned_cells(); ++c)
      if (mesh_.use(c) != mesh::Use::covered && mesh_.use(c) != mesh::Use::points)
        cells[static_cast<std::size_t>(c)] += 1.0;
  }

private:
  field::OutputBlock mesh_block(const Picture& now, std::span<const double> displacement) const
  {
    field::OutputBlock block;
    block.name = "mesh";
    block.quadrilaterals = true;
    const auto owned = static_cast<std::size_t>(mesh_.owned_vertices());
    for (Index v = 0; v < mesh_.owned_vertices(); ++v) {
      block.points.insert(block.points.end(), {mesh_.point(v)[0], mesh_.point(v)[1], 0.0});
      block.natural_point.push_back(mesh_.natural_vertex(v));
    }
    const std::vector<PetscInt> numbers = file_numbers(mesh_);
    field::OutputField use{"use", field::Rank::scalar, true, true, {}},
        rank{"rank", field::Rank::scalar, true, true, {}};
    for (Index c = 0; c < mesh_.owned_cells(); ++c) {
      for (const Index v : mesh_.cell(c)) block.cells.push_back(numbers[static_cast<std::size_t>(v)]);
      use.values.push_back(static_cast<double>(mesh_.use(c)));
      rank.values.push_back(mesh_.cell_owner(c));
    }
    block.fields.push_back(displacement_field<2>(displacement, owned));
    const fem::ElasticBody body{mesh_, now.options.elastic, now.options.element_kinematics(),
                                now.options.regions.get()};
    const field::Swelling* const swelling = d_.system.swelling.get();
    block.fields.push_back(stress_field(fem::nodal_stress(body, displacement, swelling ? &swelling->now : nullptr)));
    push_temperature(now.options, d_.system, block);
    if (now.options.post.reference_fe)
      block.fields.push_back({"relative_error_percent [%]",
                              field::Rank::scalar,
                              false,
                              false,
                              {now.relative_percent.begin(), now.relative_percent.end()}});
    block.fields.push_back(std::move(use));
    block.fields.push_back(std::move(rank));
    if (now.options.regions) {
      field::OutputField region{"region", field::Rank::scalar, true, true, {}};
      for (Index c = 0; c < mesh_.owned_cells(); ++c)
        region.values.push_back(static_cast<double>(now.options.regions->at(mesh_.centroid(c))));
      block.fields.push_back(std::move(region));
    }
    return block;
  }

  const mesh::Mesh& mesh_;
  const Discretisation& d_;
};
} // namespace

std::unique_ptr<Part> mesh_part(const mesh::Mesh& mesh, const Discretisation& d)
{
  return std::make_unique<MeshPart>(mesh, d);
}
} // namespace pdx::scene
