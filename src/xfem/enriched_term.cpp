#include "pdx/xfem/enriched_term.hpp"

#include "pdx/base/events.hpp"

namespace pdx::xfem {
namespace {
EnrichedVector gathered(std::span<const Index> rows, std::span<const double> u)
{
  EnrichedVector d(2 * static_cast<Index>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto at = 2 * static_cast<std::size_t>(rows[k]);
    d.segment<2>(static_cast<Index>(2 * k)) << u[at], u[at + 1];
  }
  return d;
}
} // namespace

EnrichedTerm::EnrichedTerm(const mesh::Mesh& mesh, const law::Elastic& law, fem::Kinematics kinematics,
                           const std::vector<PetscInt>& node_rows, const EnrichedSets& sets)
    : law_(law), kinematics_(kinematics)
{
  for (const CutElement& cut : sets.cells()) {
    const auto& vertices = mesh.cell(cut.cell);
    const bool own = cut.cell < mesh.owned_cells();
    if (!own && std::ranges::none_of(vertices, [&](Index v) { return v < mesh.owned_vertices(); })) continue;
    Part part{&cut.element, own, {}, {}, {}, {}};
    for (const Index v : vertices) part.global_rows.push_back(node_rows[static_cast<std::size_t>(v)]);
    for (const PetscInt row : cut.sets)
      if (row >= 0) part.global_rows.push_back(row);
    PDX_ASSERT(2 * static_cast<int>(part.global_rows.size()) == cut.element.unknowns());
    part.state = EnrichedVector::Zero(cut.element.unknowns());
    if (kinematics_ == fem::Kinematics::small)
      part.stiffness = enriched_tangent(cut.element, part.state, law_, kinematics_);
    parts_.push_back(std::move(part));
  }
}

void EnrichedTerm::needed_rows(std::vector<PetscInt>& rows) const
{
  for (const Part& part : parts_) rows.insert(rows.end(), part.global_rows.begin(), part.global_rows.end());
}

void EnrichedTerm::bind(const field::RowHalo& halo)
{
  owned_rows_ = halo.rows().owned();
  for (Part& part : parts_) {
    part.rows.clear();
    for (const PetscInt row : part.global_rows) part.rows.push_back(halo.local(row));
  }
}

void EnrichedTerm::add_residual(std::span<const double> u, std::span<double> r) const
{
  static Event event("xfem_residual");
  const Timed timed(event);
  for (const Part& part : parts_) {
    const EnrichedVector d = gathered(part.rows, u);
    const EnrichedVector force =
        constant_jacobian() ? EnrichedVector(part.stiffness * d) : enriched_force(*part.element, d, law_, kinematics_);
    for (std::size_t k = 0; k < part.rows.size(); ++k) {
      if (part.rows[k] >= owned_rows_) continue;
      const auto at = 2 * static_cast<std::size_t>(part.rows[k]);
      r[at] += force[static_cast<Index>(2 * k)];
      r[at + 1] += force[static_cast<Index>(2 * k + 1)];
    }
  }
}

double EnrichedTerm::energy(std::span<const double> u) const
{
  double sum = 0.0;
  for (const Part& part : parts_) {
    if (!part.counted) continue;
    const EnrichedVector d = gathered(part.rows, u);
    sum += constant_jacobian() ? 0.5 * d.dot(part.stiffness * d) : enriched_energy(*part.element, d, law_, kinematics_);
  }
  return sum;
}

void EnrichedTerm::linearise(std::span<const double> u)
{
  if (constant_jacobian()) return;
  for (Part& part : parts_) part.state = gathered(part.rows, u);
}

void EnrichedTerm::couplings(field::Couplings& couplings, bool) const
{
  std::vector<std::pair<Index, Index>> pairs;
  for (const Part& part : parts_)
    for (const Index row : part.rows)
      for (const Index column : part.rows)
        if (row != column && row < owned_rows_) pairs.emplace_back(row, column);
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  for (const auto& [row, column] : pairs) couplings.add(row, column);
}

void EnrichedTerm::add_jacobian(field::BlockAdder& adder, bool) const
{
  static Event event("xfem_jacobian");
  const Timed timed(event);
  for (const Part& part : parts_) {
    const EnrichedMatrix k =
        constant_jacobian() ? part.stiffness : enriched_tangent(*part.element, part.state, law_, kinematics_);
    adder.add(part.rows, part.rows, {k.data(), static_cast<std::size_t>(k.size())});
  }
}
} // namespace pdx::xfem
