#include "pdx/couple/coarse_mesh.hpp"

#include "pdx/base/events.hpp"
#include "pdx/mesh/locate.hpp"
#include "pdx/mesh/vertex_halo.hpp"

#include <numeric>

namespace pdx::couple {
namespace {
/// A coarse component is held when prescribed particles have at least this share of the weight that leans on it: a
/// layer of a horizon holds the nodes at its inner border, which lean on it by half.
constexpr double kHeldShare = 0.3;
/// Held coarse components take no correction: their diagonal is this much above the others.
constexpr double kHeldStiffness = 1e8;
/// Held particles too few to hold a coarse component are springs on it, each this stiff: without them a body that only
/// such particles hold would leave the coarse level singular.
constexpr double kSpringStiffness = 1.0;

std::vector<PetscInt> vertex_rows(const mesh::Mesh& mesh, const field::Rows& rows)
{
  std::vector<PetscInt> all(static_cast<std::size_t>(mesh.vertices()), -1);
  std::iota(all.begin(), all.begin() + mesh.owned_vertices(), rows.first);
  mesh::fill_halo(mesh, MPIU_INT, 1, all.data());
  return all;
}
} // namespace

CoarseMesh::CoarseMesh(fem::ElasticBody body, const NodeField& node_field, std::span<const Index> nodes,
                       std::span<const ParticlePlace> particles, const field::System& system)
    : body_(body), node_field_(node_field),
      rows_(field::Rows::number(body.mesh.comm(), 2, body.mesh.owned_vertices(), 0, 0)), scale_(system.scale)
{
  const mesh::Mesh& mesh = body_.mesh;
  const std::vector<PetscInt> rows = vertex_rows(mesh, rows_);
  halo_ = std::make_unique<field::RowHalo>(rows_, rows);
  for (const PetscInt row : rows) local_rows_.push_back(halo_->local(row));
  for (Index c = 0; c < mesh.cells(); ++c)
    for (const Index v : mesh.cell(c))
      if (v < mesh.owned_vertices()) {
        cells_.push_back(c);
        break;
      }
  auto& [offsets, columns, weights] = interpolation_;
  offsets.assign(1, 0);
  for (const Index v : nodes) {
    columns.push_back(local_rows_[static_cast<std::size_t>(v)]);
    weights.push_back(1.0);
    offsets.push_back(columns.size());
  }
  for (const ParticlePlace& particle : particles) {
    const auto w = mesh::bilinear_weights(mesh.corners(particle.cell), particle.x);
    for (std::size_t a = 0; a < 4; ++a) {
      columns.push_back(local_rows_[static_cast<std::size_t>(mesh.cell(particle.cell)[a])]);
      weights.push_back(w[a]);
    }
    offsets.push_back(columns.size());
  }
  hold(nodes, particles, system);
}

void CoarseMesh::hold(std::span<const Index> nodes, std::span<const ParticlePlace> particles,
                      const field::System& system)
{
  const auto size = static_cast<std::size_t>(halo_->size());
  std::vector<double> sums(size * 3, 0.0); // weight of held x, of held y, of all that leans on a coarse row
  for (std::size_t k = 0; k < particles.size(); ++k) {
    const std::size_t row = nodes.size() + k;
    for (std::size_t at = interpolation_.offsets[row]; at < interpolation_.offsets[row + 1]; ++at) {
      double* sum = &sums[3 * static_cast<std::size_t>(interpolation_.columns[at])];
      for (std::size_t a = 0; a < 2; ++a)
        if (system.held[2 * static_cast<std::size_t>(particles[k].row) + a]) sum[a] += interpolation_.weights[at];
      sum[2] += interpolation_.weights[at];
    }
  }
  halo_->reduce(sums, 3);
  std::vector<double> flags(static_cast<std::size_t>(rows_.owned()) * 2, 0.0), all;
  leaning_.assign(flags.size(), 0.0);
  for (std::size_t v = 0; v < static_cast<std::size_t>(rows_.owned()); ++v)
    for (std::size_t a = 0; a < 2; ++a) {
      leaning_[2 * v + a] = sums[3 * v + a];
      flags[2 * v + a] = sums[3 * v + 2] > 0.0 && sums[3 * v + a] >= kHeldShare * sums[3 * v + 2];
    }
  for (std::size_t k = 0; k < nodes.size(); ++k)
    for (std::size_t a = 0; a < 2; ++a) flags[2 * static_cast<std::size_t>(nodes[k]) + a] = system.held[2 * k + a];
  halo_->fetch(flags, 2, all);
  held_.assign(all.begin(), all.end());
}

void CoarseMesh::add_springs(field::BlockAdder& adder) const
{
  for (Index row = 0; row < rows_.owned(); ++row) {
    const double* weight = &leaning_[2 * static_cast<std::size_t>(row)];
    const std::array values{kSpringStiffness * scale_ * weight[0], 0.0, 0.0, kSpringStiffness * scale_ * weight[1]};
    if (weight[0] > 0.0 || weight[1] > 0.0) adder.add(std::span(&row, 1), std::span(&row, 1), values);
  }
}

MatHandle CoarseMesh::assemble(std::span<const double> u)
{
  static Event event("solve_coarse_assembly");
  Timed timed(event);
  field::Couplings couplings(*halo_);
  fem::count_couplings(body_.mesh, cells_, local_rows_, couplings);
  MatHandle matrix;
  PDX_CALL(MatCreate(rows_.comm, matrix.out()));
  PDX_CALL(MatSetSizes(matrix.get(), 2 * rows_.owned(), 2 * rows_.owned(), PETSC_DETERMINE, PETSC_DETERMINE));
  PDX_CALL(MatSetBlockSize(matrix.get(), 2));
  PDX_CALL(MatSetType(matrix.get(), MATBAIJ)); // blocks assemble several times faster; multigrid wants plain rows
  PDX_CALL(MatXAIJSetPreallocation(matrix.get(), 2, couplings.diagonal.data(), couplings.off_diagonal.data(), nullptr,
                                   nullptr));
  PDX_CALL(MatSetOption(matrix.get(), MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  const bool small = body_.kinematics == fem::Kinematics::small;
  field::BlockAdder adder(matrix.get(), *halo_, held_);
  fem::assemble_stiffness(body_, cells_, local_rows_, small ? std::vector<double>{} : node_field_.displacement(u),
                          adder);
  add_springs(adder);
  adder.finish(kHeldStiffness * scale_);
  PDX_CALL(MatConvert(matrix.get(), MATAIJ, MAT_INPLACE_MATRIX, matrix.address()));
  return matrix;
}

std::vector<double> CoarseMesh::coordinates() const
{
  std::vector<double> x;
  for (Index v = 0; v < rows_.owned(); ++v)
    for (Eigen::Index a = 0; a < 2; ++a) x.push_back(body_.mesh.point(v)[a]);
  return x;
}
} // namespace pdx::couple
