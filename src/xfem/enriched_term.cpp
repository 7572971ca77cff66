#include "pdx/xfem/enriched_term.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/fem/swelling_kernel.hpp"
#include "pdx/xfem/enriched_kernel.hpp"

#include <stdexcept>

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

EnrichedTerm::EnrichedTerm(const mesh::Mesh& mesh, const law::Elastic& law, law::Kinematics kinematics,
                           const std::vector<PetscInt>& node_rows, const EnrichedSets& sets,
                           const law::Regions* regions)
    : kinematics_(kinematics)
{
  for (const CutElement& cut : sets.cells()) {
    const auto& vertices = mesh.cell(cut.cell);
    const bool own = cut.cell < mesh.owned_cells();
    if (!own && std::ranges::none_of(vertices, [&](Index v) { return v < mesh.owned_vertices(); })) continue;
    Part part{&cut.element,
              own,
              {},
              {},
              {},
              {},
              regions ? regions->elastic(regions->at(mesh.centroid(cut.cell))) : law,
              mesh.corners(cut.cell)};
    for (const Index v : vertices) part.global_rows.push_back(node_rows[static_cast<std::size_t>(v)]);
    for (const PetscInt row : cut.sets)
      if (row >= 0) part.global_rows.push_back(row);
    PDX_ASSERT(2 * static_cast<int>(part.global_rows.size()) == cut.element.unknowns());
    part.state = EnrichedVector::Zero(cut.element.unknowns());
    if (kinematics_ == law::Kinematics::small)
      part.stiffness = enriched_tangent(cut.element, part.state, part.law, kinematics_);
    parts_.push_back(std::move(part));
  }
  for (Index v = 0; v < mesh.owned_vertices(); ++v)
    for (const EnrichedSet& set : sets.of(v))
      ties_.push_back({node_rows[static_cast<std::size_t>(v)], set.row, shifted_step(opposite(set.side), set.side)});
}

void EnrichedTerm::needed_rows(std::vector<PetscInt>& rows) const
{
  for (const Part& part : parts_) rows.insert(rows.end(), part.global_rows.begin(), part.global_rows.end());
}

void EnrichedTerm::bind(const field::RowHalo& halo)
{
  owned_rows_ = halo.rows().owned();
  first_row_ = halo.rows().first;
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
    EnrichedVector force = constant_jacobian() ? EnrichedVector(part.stiffness * d)
                                               : enriched_force(*part.element, d, part.law, kinematics_);
    if (part.swelling.size() > 0) force -= part.swelling;
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
    sum += constant_jacobian() ? 0.5 * d.dot(part.stiffness * d)
                               : enriched_energy(*part.element, d, part.law, kinematics_);
    if (part.swelling.size() > 0) sum += part.swelling_energy - part.swelling.dot(d);
  }
  return sum;
}

void EnrichedTerm::swell(const field::FreeStrain& strain)
{
  if (!constant_jacobian()) throw std::logic_error("cut elements of finite strain have no free strain");
  for (Part& part : parts_) {
    part.swelling = EnrichedVector::Zero(part.element->unknowns());
    part.swelling_energy = 0.0;
    for (const Side side : kSides) {
      fem::SwellingLoad load;
      for (const PartPoint& at : part.element->cell.points(side))
        load.add(at, strain(fem::place_of(part.corners, at.shape)), part.law);
      part.swelling.noalias() += side_map(*part.element, side).transpose() * load.force;
      part.swelling_energy += load.energy;
    }
  }
}

void EnrichedTerm::linearise(std::span<const double> u)
{
  if (constant_jacobian()) return;
  for (Part& part : parts_) part.state = gathered(part.rows, u);
}

template <class Visit> void EnrichedTerm::for_each_side(Visit&& visit) const
{
  for (const Part& part : parts_)
    for (const Side side : kSides) {
      const std::span<const PartPoint> points = part.element->cell.points(side);
      if (points.empty()) continue;
      std::array<Index, 4> rows;
      std::size_t set = 4;
      for (std::size_t a = 0; a < 4; ++a) {
        const bool far = part.element->enriched[a] && part.element->factor(a, side) != 0.0;
        rows[a] = part.rows[far ? set : a];
        set += part.element->enriched[a];
      }
      visit(points, rows, part.law);
    }
}

void EnrichedTerm::add_mass(std::span<double> mass) const
{
  for_each_side([&](std::span<const PartPoint> points, const std::array<Index, 4>& rows, const law::Elastic& law) {
    double area = 0.0;
    for (const PartPoint& at : points) area += at.area;
    for (const Index row : rows)
      if (row < owned_rows_) mass[static_cast<std::size_t>(row)] += 0.25 * law.density * law.thickness * area;
  });
}

/// With equal masses at all corner values, the largest eigenvalue of the stiffness itself is the sharp bound.
void EnrichedTerm::add_stiffness_bound(std::span<double> blocks) const
{
  for_each_side([&](std::span<const PartPoint> points, const std::array<Index, 4>& rows, const law::Elastic& law) {
    const double bound =
        symmetric_eigenvalues(fem::part_tangent(points, fem::ElementVector::Zero(), law, law::Kinematics::small))[7];
    for (const Index row : rows)
      if (row < owned_rows_)
        for (const std::size_t diagonal : {0, 3}) blocks[4 * static_cast<std::size_t>(row) + diagonal] += bound;
  });
}

void EnrichedTerm::ties(std::vector<field::Tie>& ties) const
{
  for (const GlobalTie& tie : ties_)
    ties.push_back({static_cast<Index>(tie.row - first_row_), static_cast<Index>(tie.set - first_row_), tie.factor});
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
        constant_jacobian() ? part.stiffness : enriched_tangent(*part.element, part.state, part.law, kinematics_);
    adder.add(part.rows, part.rows, {k.data(), static_cast<std::size_t>(k.size())});
  }
}
} // namespace pdx::xfem
