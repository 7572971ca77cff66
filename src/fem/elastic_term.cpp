#include "pdx/fem/elastic_term.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/fem/element_action.hpp"
#include "pdx/fem/swelling_kernel.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace pdx::fem {
namespace {
/// With more shapes the matrices of the elements no longer stay in cache, and a sparse matrix is as good.
constexpr int kMostShapes = 16;

/// Largest eigenvalue of the stiffness over the lumped mass of unit density and thickness [N/m^3].
double largest_ratio(const ElementMatrix& stiffness, const Eigen::Vector4d& areas)
{
  ElementVector scale;
  for (int a = 0; a < 4; ++a) scale.segment<2>(2 * a).setConstant(1.0 / std::sqrt(areas[a]));
  const Eigen::Matrix<double, 8, 8> scaled = scale.asDiagonal() * stiffness * scale.asDiagonal();
  return symmetric_eigenvalues(scaled)[7];
}
} // namespace

ElasticTerm::ElasticTerm(const mesh::Mesh& mesh, const law::Elastic& law, Kinematics kinematics,
                         std::vector<PetscInt> node_rows, const law::Regions* regions, const CornerAreas* areas)
    : body_{mesh, law, kinematics, regions}, areas_(areas ? *areas : own_areas_.emplace(mesh)),
      node_rows_(std::move(node_rows))
{
  int rank = 0;
  MPI_Comm_rank(mesh.comm(), &rank);
  for (const Index c : mesh.cells(mesh::Use::plain)) {
    const bool own = mesh.cell_owner(c) == rank;
    const bool touches = std::ranges::any_of(mesh.cell(c), [&](Index v) { return v < mesh.owned_vertices(); });
    if (!own && !touches) continue;
    cells_.push_back(c);
    counted_.push_back(own);
  }
  if (kinematics == Kinematics::small) keep_stiffness();
}

void ElasticTerm::keep_stiffness()
{
  std::vector<ReusedStiffness> reused = reused_stiffness(body_);
  std::vector<Index> last(reused.size(), -1); // shape of each law
  for (const Index c : cells_) {
    const std::size_t number = body_.number(c);
    const int before = reused[number].integrations();
    const ElementMatrix& k = reused[number].of(body_.mesh.corners(c));
    if (reused[number].integrations() > before) {
      if (reused[number].integrations() > kMostShapes) {
        stiffness_.clear();
        shape_.clear();
        return;
      }
      last[number] = static_cast<Index>(stiffness_.size());
      stiffness_.push_back(k);
    }
    shape_.push_back(last[number]);
  }
}

void ElasticTerm::needed_rows(std::vector<PetscInt>& rows) const
{
  for (const Index c : cells_)
    for (const Index v : body_.mesh.cell(c))
      if (v >= body_.mesh.owned_vertices()) rows.push_back(node_rows_[static_cast<std::size_t>(v)]);
}

void ElasticTerm::bind(const field::RowHalo& halo)
{
  owned_rows_ = halo.rows().owned();
  local_rows_.assign(node_rows_.size(), -1);
  for (const Index c : cells_)
    for (const Index v : body_.mesh.cell(c)) {
      Index& row = local_rows_[static_cast<std::size_t>(v)];
      if (row < 0) row = halo.local(node_rows_[static_cast<std::size_t>(v)]);
    }
  sort_out_free_cells();
  sort_for_sweeps();
}

void ElasticTerm::sort_for_sweeps()
{
  sweeps_.clear();
  for (const bool far : {false, true}) {
    if (far && far_.empty()) continue;
    std::vector<std::vector<ElementSweep::Element>> elements(body_.laws());
    if (elements.size() == 1) elements[0].reserve(cells_.size());
    for (std::size_t k = 0; k < cells_.size(); ++k)
      if (far_.empty() || (far_[k] != 0) == far)
        elements[body_.number(cells_[k])].push_back(
            {body_.mesh.corners(cells_[k]), rows_of(cells_[k]), counted_[k] != 0});
    for (std::size_t k = 0; k < elements.size(); ++k)
      sweeps_.emplace_back(body_.regions ? body_.regions->elastic(k) : body_.law, body_.kinematics, elements[k],
                           owned_rows_);
    if (!far) near_sweeps_ = sweeps_.size();
  }
}

void ElasticTerm::part(std::span<const std::uint8_t> marked, std::span<std::uint8_t> near)
{
  far_.clear();
  for (const Index c : cells_) {
    const CellRows rows = rows_of(c);
    const bool touches = std::ranges::any_of(rows, [&](Index row) { return marked[static_cast<std::size_t>(row)]; });
    for (std::size_t a = 0; a < 4 && touches; ++a) near[static_cast<std::size_t>(rows[a])] = 1;
    far_.push_back(!touches);
  }
  sort_for_sweeps();
}

void ElasticTerm::add_near(std::span<const double> u, std::span<double> r) const
{
  static Event event("fe_residual");
  const Timed timed(event);
  for (std::size_t k = 0; k < near_sweeps_; ++k) sweeps_[k].add_force(u, r);
}

void ElasticTerm::add_far(std::span<const double> u, std::span<double> r) const
{
  static Event event("fe_residual");
  const Timed timed(event);
  for (std::size_t k = near_sweeps_; k < sweeps_.size(); ++k) sweeps_[k].add_force(u, r);
}

void ElasticTerm::sort_out_free_cells()
{
  free_.clear();
  border_.clear();
  const bool assembled = stiffness_.empty();
  for (const ElementMatrix& k : stiffness_) {
    free_.push_back({k, k, {}});
    for (int a = 0; a < 4; ++a) free_.back().off_diagonal.block<2, 2>(2 * a, 2 * a).setZero();
  }
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const CellRows rows = rows_of(cells_[k]);
    if (!assembled && std::ranges::all_of(rows, [&](Index row) { return row < owned_rows_; })) {
      free_[static_cast<std::size_t>(shape_[k])].rows.push_back(rows);
    } else
      border_.push_back(cells_[k]);
  }
}

ElasticTerm::CellRows ElasticTerm::rows_of(Index cell) const
{
  CellRows rows;
  for (std::size_t a = 0; a < 4; ++a) rows[a] = local_rows_[static_cast<std::size_t>(body_.mesh.cell(cell)[a])];
  return rows;
}

void ElasticTerm::add_residual(std::span<const double> u, std::span<double> r) const
{
  static Event event("fe_residual");
  const Timed timed(event);
  for (const ElementSweep& sweep : sweeps_) sweep.add_force(u, r);
  for (std::size_t k = 0; k < swelling_.size(); ++k) r[k] -= swelling_[k];
}

double ElasticTerm::energy(std::span<const double> u) const
{
  double sum = 0.0;
  for (const ElementSweep& sweep : sweeps_) sum += sweep.energy(u);
  if (swelling_.empty()) return sum;
  return sum - std::inner_product(swelling_.begin(), swelling_.end(), u.begin(), 0.0) + swelling_energy_;
}

void ElasticTerm::swell(const field::FreeStrain& strain)
{
  if (!constant_jacobian()) throw std::logic_error("elements of finite strain have no free strain");
  swelling_.assign(2 * static_cast<std::size_t>(owned_rows_), 0.0);
  swelling_energy_ = 0.0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const SwellingLoad load = swelling_load(body_.mesh.corners(cells_[k]), body_.law_of(cells_[k]), strain);
    if (counted_[k]) swelling_energy_ += load.energy;
    const CellRows rows = rows_of(cells_[k]);
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t d = 0; d < 2 && rows[a] < owned_rows_; ++d)
        swelling_[2 * static_cast<std::size_t>(rows[a]) + d] += load.force[static_cast<Index>(2 * a + d)];
  }
}

void ElasticTerm::linearise(std::span<const double> u)
{
  if (constant_jacobian()) return;
  node_displacement_.assign(2 * local_rows_.size(), 0.0);
  for (std::size_t v = 0; v < local_rows_.size(); ++v)
    if (local_rows_[v] >= 0) std::copy_n(u.begin() + 2 * local_rows_[v], 2, node_displacement_.begin() + 2 * v);
}

void ElasticTerm::couplings(field::Couplings& couplings, bool whole) const
{
  count_couplings(body_.mesh, whole ? cells_ : border_, local_rows_, couplings);
}

void ElasticTerm::add_jacobian(field::BlockAdder& adder, bool whole) const
{
  static Event event("fe_jacobian");
  const Timed timed(event);
  assemble_stiffness(body_, whole ? cells_ : border_, local_rows_, node_displacement_, adder);
  if (!whole) add_free_diagonal(adder);
}

void ElasticTerm::add_free_diagonal(field::BlockAdder& adder) const
{
  std::vector<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>> blocks(static_cast<std::size_t>(owned_rows_),
                                                                   Eigen::Matrix2d::Zero());
  std::vector<std::uint8_t> touched(blocks.size(), 0);
  for (const FreeCells& shape : free_)
    for (const CellRows& rows : shape.rows)
      for (int a = 0; a < 4; ++a) {
        const auto row = static_cast<std::size_t>(rows[static_cast<std::size_t>(a)]);
        blocks[row] += shape.stiffness.block<2, 2>(2 * a, 2 * a);
        touched[row] = 1;
      }
  for (Index row = 0; row < owned_rows_; ++row)
    if (touched[static_cast<std::size_t>(row)])
      adder.add({&row, 1}, {&row, 1}, {blocks[static_cast<std::size_t>(row)].data(), 4});
}

void ElasticTerm::add_mass(std::span<double> mass) const
{
  for (const Index c : cells_) {
    const law::Elastic& law = body_.law_of(c);
    const double per_area = law.density * law.thickness;
    const CellRows rows = rows_of(c);
    const Eigen::Vector4d& areas = areas_.of(c);
    for (std::size_t a = 0; a < 4; ++a)
      if (rows[a] < owned_rows_) mass[static_cast<std::size_t>(rows[a])] += per_area * areas[static_cast<Index>(a)];
  }
}

void ElasticTerm::add_bound(bool far_only, std::span<double> blocks) const
{
  std::vector<ReusedStiffness> reused = reused_stiffness(body_);
  std::vector<int> integrations(reused.size(), 0);
  std::vector<Eigen::Vector4d> bounds(reused.size()); // of the shape at hand, per corner [N/m]
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    if (far_only && (far_.empty() || !far_[k])) continue;
    const Index c = cells_[k];
    const Corners corners = body_.mesh.corners(c);
    const std::size_t number = body_.number(c);
    const ElementMatrix& stiffness = reused[number].of(corners);
    Eigen::Vector4d& bound = bounds[number];
    if (reused[number].integrations() > integrations[number]) {
      const Eigen::Vector4d& areas = areas_.of(c);
      bound = largest_ratio(stiffness, areas) * areas;
      integrations[number] = reused[number].integrations();
    }
    const CellRows rows = rows_of(c);
    for (std::size_t a = 0; a < 4; ++a)
      if (rows[a] < owned_rows_)
        for (const std::size_t diagonal : {0, 3})
          blocks[4 * static_cast<std::size_t>(rows[a]) + diagonal] += bound[static_cast<Index>(a)];
  }
}

void ElasticTerm::add_tangent_action(std::span<const double> x, std::span<double> y) const
{
  static Event event("fe_tangent");
  const Timed timed(event);
  for (const FreeCells& shape : free_)
    add_element_action(std::span<const double, 64>(shape.off_diagonal.data(), 64), shape.rows, x.data(), y.data());
}
} // namespace pdx::fem
