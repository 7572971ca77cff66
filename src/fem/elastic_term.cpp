#include "pdx/fem/elastic_term.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/symmetric.hpp"
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/fem/element_action.hpp"
#include "pdx/fem/swelling_kernel.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <utility>

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
  MPI_Comm_rank(mesh.comm(), &rank_);
  for (const Index c : mesh.cells(mesh::Use::plain))
    if (is_taken(c)) cells_.push_back(c);
}

bool ElasticTerm::is_taken(Index cell) const
{
  const mesh::Mesh& mesh = body_.mesh;
  if (mesh.use(cell) != mesh::Use::plain) return false;
  return is_mine(cell) || std::ranges::any_of(mesh.cell(cell), [&](Index v) { return v < mesh.owned_vertices(); });
}

void ElasticTerm::change(std::span<const Index> cells, std::vector<PetscInt> node_rows)
{
  node_rows_ = std::move(node_rows);
  tangent_known_ = false;
  count_only(std::nullopt);
  for (const Index c : cells) {
    const auto at = std::ranges::lower_bound(cells_, c);
    const bool was = at != cells_.end() && *at == c;
    if (was == is_taken(c)) continue;
    (was ? leaving_ : entering_).push_back(c);
    if (was)
      cells_.erase(at);
    else
      cells_.insert(at, c);
  }
  if (!far_.empty()) { // parted anew
    far_.clear();
    sweeps_.clear();
  }
  for (const std::vector<Index>* changed : {&leaving_, &entering_})
    for (const Index c : *changed)
      for (const Index v : body_.mesh.cell(c))
        if (v < body_.mesh.owned_vertices() && !sums_.empty()) sum_up(v);
}

void ElasticTerm::count_only(std::optional<std::vector<Index>> cells)
{
  counted_only_.reset();
  if (!cells) return;
  std::erase_if(*cells, [this](Index c) { return !is_taken(c); });
  counted_only_ = swept(*cells);
}

void ElasticTerm::know_tangent() const
{
  if (std::exchange(tangent_known_, true)) return;
  shape_.clear();
  stiffness_.clear();
  if (constant_jacobian()) keep_stiffness();
  sort_out_free_cells();
}

void ElasticTerm::keep_stiffness() const
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

bool ElasticTerm::has_cell_at(Index vertex) const
{
  return std::ranges::any_of(body_.mesh.finder().at(vertex), [this](Index c) { return is_taken(c); });
}

std::vector<Index> ElasticTerm::halo_vertices() const
{
  std::vector<Index> found;
  for (Index v = body_.mesh.owned_vertices(); v < body_.mesh.vertices(); ++v)
    if (has_cell_at(v)) found.push_back(v);
  return found;
}

void ElasticTerm::needed_rows(std::vector<PetscInt>& rows) const
{
  for (const Index v : halo_vertices()) rows.push_back(node_rows_[static_cast<std::size_t>(v)]);
}

/// @param now per local row before: local row now, left empty where all are as before   @return were they bound before?
bool ElasticTerm::number_rows(const field::RowHalo& halo, std::vector<Index>& now)
{
  const field::Rows& rows = halo.rows();
  const std::vector<Index> before = std::move(local_rows_);
  local_rows_.assign(node_rows_.size(), -1);
  row_vertex_.assign(static_cast<std::size_t>(rows.nodes), -1);
  for (Index v = 0; v < body_.mesh.owned_vertices(); ++v) {
    const auto k = static_cast<std::size_t>(v);
    if (node_rows_[k] < 0) continue;
    local_rows_[k] = node_rows_[k] - rows.first;
    row_vertex_[static_cast<std::size_t>(local_rows_[k])] = v;
  }
  for (const Index v : halo_vertices())
    local_rows_[static_cast<std::size_t>(v)] = halo.local(node_rows_[static_cast<std::size_t>(v)]);
  owned_rows_ = rows.owned();
  if (before.size() != local_rows_.size()) return false;
  if (before == local_rows_) return true;
  Index most = 0;
  for (const Index row : before) most = std::max(most, row + 1);
  now.assign(static_cast<std::size_t>(most), -1);
  for (std::size_t v = 0; v < before.size(); ++v)
    if (before[v] >= 0) now[static_cast<std::size_t>(before[v])] = local_rows_[v];
  return true;
}

void ElasticTerm::bind(const field::RowHalo& halo)
{
  tangent_known_ = false;
  std::vector<Index> now;
  const bool again = number_rows(halo, now) && !sweeps_.empty();
  if (!again)
    sort_for_sweeps();
  else
    for (std::size_t law = 0; law < sweeps_.size(); ++law) {
      std::vector<Index> leaving = leaving_, entering = entering_;
      for (std::vector<Index>* cells : {&leaving, &entering})
        std::erase_if(*cells, [&](Index c) { return body_.number(c) != law; });
      sweeps_[law].change({leaving, entering, now, owned_rows_}, [this](Index c) { return element(c); });
    }
  leaving_.clear();
  entering_.clear();
}

/// One sweep for each law.
std::vector<ElementSweep> ElasticTerm::swept(std::span<const Index> cells) const
{
  std::vector<std::vector<Index>> by_law(body_.laws());
  for (const Index c : cells) by_law[body_.number(c)].push_back(c);
  std::vector<ElementSweep> sweeps;
  for (std::size_t law = 0; law < by_law.size(); ++law)
    sweeps.emplace_back(
        body_.regions ? body_.regions->elastic(law) : body_.law, body_.kinematics, by_law[law],
        [this](Index c) { return element(c); }, owned_rows_);
  return sweeps;
}

void ElasticTerm::sort_for_sweeps()
{
  std::vector<Index> near = cells_, far;
  if (!far_.empty()) {
    near.clear();
    for (std::size_t k = 0; k < cells_.size(); ++k) (far_[k] ? far : near).push_back(cells_[k]);
  }
  sweeps_ = swept(near);
  near_sweeps_ = sweeps_.size();
  if (far_.empty()) return;
  for (ElementSweep& sweep : swept(far)) sweeps_.push_back(std::move(sweep));
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

void ElasticTerm::add_far_bound(std::span<double> blocks) const
{
  know_ratios();
  for (std::size_t k = 0; k < far_.size(); ++k) {
    if (!far_[k]) continue;
    const Index c = cells_[k];
    const CellRows rows = rows_of(c);
    for (std::size_t a = 0; a < 4; ++a)
      if (rows[a] < owned_rows_)
        for (const std::size_t diagonal : {0, 3})
          blocks[4 * static_cast<std::size_t>(rows[a]) + diagonal] +=
              ratios_[static_cast<std::size_t>(c)] * areas_.of(c)[static_cast<Index>(a)];
  }
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

void ElasticTerm::sort_out_free_cells() const
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
  for (const ElementSweep& sweep : counted_only_ ? *counted_only_ : sweeps_) sum += sweep.energy(u);
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
    if (is_mine(cells_[k])) swelling_energy_ += load.energy;
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
  if (!whole) know_tangent();
  count_couplings(body_.mesh, whole ? cells_ : border_, local_rows_, couplings);
}

void ElasticTerm::add_jacobian(field::BlockAdder& adder, bool whole) const
{
  static Event event("fe_jacobian");
  const Timed timed(event);
  if (!whole) know_tangent();
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

/// Of all cells of the mesh: what they are used for does not matter.
void ElasticTerm::know_ratios() const
{
  if (!ratios_.empty()) return;
  std::vector<ReusedStiffness> reused = reused_stiffness(body_);
  std::vector<int> integrations(reused.size(), 0);
  std::vector<double> ratio(reused.size(), 0.0); // of the shape at hand
  ratios_.reserve(static_cast<std::size_t>(body_.mesh.cells()));
  for (Index c = 0; c < body_.mesh.cells(); ++c) {
    const std::size_t number = body_.number(c);
    const ElementMatrix& stiffness = reused[number].of(body_.mesh.corners(c));
    if (reused[number].integrations() > integrations[number]) ratio[number] = largest_ratio(stiffness, areas_.of(c));
    integrations[number] = reused[number].integrations();
    ratios_.push_back(ratio[number]);
  }
}

void ElasticTerm::know_vertices() const
{
  if (!sums_.empty()) return;
  know_ratios();
  sums_.resize(static_cast<std::size_t>(body_.mesh.owned_vertices()));
  for (Index v = 0; v < body_.mesh.owned_vertices(); ++v) sum_up(v);
}

void ElasticTerm::sum_up(Index vertex) const
{
  Vector<2>& sum = sums_[static_cast<std::size_t>(vertex)] = Vector<2>(0.0, 0.0);
  for (const Index c : body_.mesh.finder().at(vertex)) {
    if (body_.mesh.use(c) != mesh::Use::plain) continue;
    const law::Elastic& law = body_.law_of(c);
    const auto corner = std::ranges::find(body_.mesh.cell(c), vertex) - body_.mesh.cell(c).begin();
    const double area = areas_.of(c)[static_cast<Index>(corner)];
    sum += Vector<2>(law.density * law.thickness * area, ratios_[static_cast<std::size_t>(c)] * area);
  }
}

void ElasticTerm::add_mass_in(field::RowRanges wanted, std::span<double> mass) const
{
  know_vertices();
  for (const auto& [first, end] : wanted)
    for (auto row = static_cast<std::size_t>(first); row < std::min<std::size_t>(end, row_vertex_.size()); ++row)
      if (row_vertex_[row] >= 0) mass[row] += sums_[static_cast<std::size_t>(row_vertex_[row])][0];
}

void ElasticTerm::add_stiffness_bound_in(field::RowRanges wanted, std::span<double> blocks) const
{
  know_vertices();
  for (const auto& [first, end] : wanted)
    for (auto row = static_cast<std::size_t>(first); row < std::min<std::size_t>(end, row_vertex_.size()); ++row)
      for (const std::size_t diagonal : {0, 3})
        if (row_vertex_[row] >= 0) blocks[4 * row + diagonal] += sums_[static_cast<std::size_t>(row_vertex_[row])][1];
}

void ElasticTerm::add_tangent_action(std::span<const double> x, std::span<double> y) const
{
  static Event event("fe_tangent");
  const Timed timed(event);
  know_tangent();
  for (const FreeCells& shape : free_)
    add_element_action(std::span<const double, 64>(shape.off_diagonal.data(), 64), shape.rows, x.data(), y.data());
}
} // namespace pdx::fem
