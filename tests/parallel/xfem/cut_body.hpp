#pragma once
#include "pdx/fem/elastic_term.hpp"
#include "pdx/mesh/vertex_halo.hpp"
#include "pdx/xfem/enriched_term.hpp"
#include "pdx/xfem/loads.hpp"
#include "support/gmsh_grid.hpp"
#include "support/tangent.hpp"

#include <functional>
#include <memory>

namespace pdx::test {
/// A displacement [m] that may jump over a crack.
using JumpField = std::function<Vector<2>(const Vector<2>& x, xfem::Side side)>;

struct CutBodyOptions {
  std::vector<crack::Polyline> cracks; ///< [m]
  Grid grid{{{0.0, 0.0}, {1.0, 1.0}}, {6, 6}, {}};
  law::Kinematics kinematics = law::Kinematics::small;
  std::function<bool(const Vector<2>& centroid)> covered; ///< empty: no cell is
  xfem::EnrichmentRule rule;
  law::Elastic law{10.0, 0.3, law::Plane::stress, 0.2};
};

/// Elements, some of them cut; rows for all nodes of plain and cut cells and all enriched sets. Collective.
class CutBody {
public:
  explicit CutBody(CutBodyOptions given, MPI_Comm comm = PETSC_COMM_WORLD)
      : options(std::move(given)), mesh(grid_mesh(comm, options.grid)), cracks(options.cracks, mesh.bounds()),
        sets(covered(mesh, options), cracks, options.rule), node_rows(number())
  {
    terms.push_back(std::make_unique<fem::ElasticTerm>(mesh, options.law, options.kinematics, node_rows));
    terms.push_back(std::make_unique<xfem::EnrichedTerm>(mesh, options.law, options.kinematics, node_rows, sets));
    std::vector<PetscInt> needed;
    for (const auto& term : terms) term->needed_rows(needed);
    halo = std::make_unique<field::RowHalo>(rows, std::move(needed));
    for (const auto& term : terms) term->bind(*halo);
    load.assign(static_cast<std::size_t>(2 * rows.owned()), 0.0);
  }
  CutBody(const CutBody&) = delete;
  CutBody& operator=(const CutBody&) = delete;

  CutBodyOptions options;
  mesh::Mesh mesh;
  crack::CrackSet cracks;
  xfem::EnrichedSets sets;
  field::Rows rows;
  std::vector<PetscInt> node_rows;
  std::vector<std::unique_ptr<field::Term>> terms; ///< plain elements, cut elements
  std::unique_ptr<field::RowHalo> halo;
  std::vector<double> load; ///< owned rows * 2 [N]

  fem::NodalForces loads() { return {node_rows, rows, load}; }

  /// Owned blocks of a displacement that jumps over the one crack. A node without a set takes the field of the side it
  /// moves with.
  std::vector<double> owned_blocks(const JumpField& field) const
  {
    std::vector<double> blocks(static_cast<std::size_t>(2 * rows.owned()), 0.0);
    const auto put = [&](PetscInt row, const Vector<2>& value) {
      const auto at = static_cast<std::size_t>(2 * (row - rows.first));
      blocks[at] = value.x();
      blocks[at + 1] = value.y();
    };
    const std::vector<xfem::Side> side = sides();
    for (Index v = 0; v < mesh.owned_vertices(); ++v) {
      const PetscInt row = node_rows[static_cast<std::size_t>(v)];
      if (row < 0) continue;
      const Vector<2>& x = mesh.point(v);
      const xfem::Side here = side[static_cast<std::size_t>(v)], there = xfem::opposite(here);
      put(row, field(x, here));
      for (const xfem::EnrichedSet& set : sets.of(v))
        put(set.row, (field(x, there) - field(x, here)) / xfem::shifted_step(there, here));
    }
    return blocks;
  }
  std::vector<double> local(const std::vector<double>& owned) const
  {
    std::vector<double> all;
    halo->fetch(owned, 2, all);
    return all;
  }
  std::vector<double> internal_force(const std::vector<double>& owned) const
  {
    std::vector<double> r(owned.size(), 0.0);
    for (const auto& term : terms) term->add_residual(local(owned), r);
    return r;
  }
  double energy(const std::vector<double>& owned) const
  {
    double total = 0.0;
    for (const auto& term : terms) total += term->energy(local(owned));
    return sum(total);
  }
  /// Of all terms.
  MatHandle tangent(const std::vector<double>& owned)
  {
    std::vector<field::Term*> all;
    for (const auto& term : terms) all.push_back(term.get());
    const std::vector<std::uint8_t> held(static_cast<std::size_t>(2 * halo->size()), 0);
    return tangent_of(all, *halo, held, local(owned), 1.0);
  }

  double sum(double mine) const
  {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, mesh.comm());
    return mine;
  }
  double norm(const std::vector<double>& owned) const
  {
    double squares = 0.0;
    for (const double x : owned) squares += x * x;
    return std::sqrt(sum(squares));
  }
  double dot(const std::vector<double>& a, const std::vector<double>& b) const
  {
    double total = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) total += a[i] * b[i];
    return sum(total);
  }

private:
  static mesh::Mesh& covered(mesh::Mesh& mesh, const CutBodyOptions& options)
  {
    for (Index c = 0; options.covered && c < mesh.cells(); ++c)
      if (options.covered(mesh.centroid(c))) mesh.cover(c, 0);
    return mesh;
  }

  /// Side of each local vertex for crack 0: of its set, of the snapped cells around it, else where it lies.
  std::vector<xfem::Side> sides() const
  {
    std::vector<xfem::Side> side;
    for (Index v = 0; v < mesh.vertices(); ++v)
      side.push_back(cracks.empty() || cracks.side(0, mesh.point(v)) > 0 ? xfem::Side::plus : xfem::Side::minus);
    for (const xfem::CutElement& cut : sets.cells())
      for (std::size_t a = 0; a < 4; ++a) {
        const Index v = mesh.cell(cut.cell)[a];
        if (cut.piece) {
          if (!sets.of(v).empty()) side[static_cast<std::size_t>(v)] = sets.of(v)[0].side;
          continue;
        }
        side[static_cast<std::size_t>(v)] = cut.snapped && sets.of(v).empty() ? *cut.snapped : cut.element.side[a];
      }
    return side;
  }

  std::vector<PetscInt> number()
  {
    std::vector<PetscInt> numbers(static_cast<std::size_t>(mesh.vertices()), -1);
    for (const mesh::Use use : {mesh::Use::plain, mesh::Use::cut})
      for (const Index c : mesh.cells(use))
        for (const Index v : mesh.cell(c)) numbers[static_cast<std::size_t>(v)] = 0;
    Index nodes = 0;
    for (Index v = 0; v < mesh.owned_vertices(); ++v) nodes += numbers[static_cast<std::size_t>(v)] == 0;
    rows = field::Rows::number(mesh.comm(), 2, nodes, sets.owned(), 0);
    PetscInt next = rows.first;
    for (Index v = 0; v < mesh.owned_vertices(); ++v)
      if (numbers[static_cast<std::size_t>(v)] == 0) numbers[static_cast<std::size_t>(v)] = next++;
    mesh::fill_halo(mesh, MPIU_INT, 1, numbers.data());
    sets.number(next);
    return numbers;
  }
};
} // namespace pdx::test
