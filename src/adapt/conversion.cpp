#include "pdx/adapt/conversion.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/fem/shape.hpp"
#include "pdx/geom/box_cover.hpp"

#include "cover_list.hpp"
#include "principal_strains.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::adapt {
namespace {
/// A cell that asks.
struct Asking {
  Index body;
  std::array<double, 4> box; ///< grown by the margin: lower and upper corner [m]
};

bool overlap(const std::array<double, 4>& a, const geom::Box<2>& b)
{
  return b.upper[0] > a[0] && b.upper[1] > a[1] && b.lower[0] < a[2] && b.lower[1] < a[3];
}

/// A box around all of them; there are some.
std::array<double, 4> around(std::span<const Asking> asking)
{
  std::array<double, 4> all = asking.front().box;
  for (const Asking& by : asking)
    for (std::size_t d = 0; d < 2; ++d) {
      all[d] = std::min(all[d], by.box[d]);
      all[2 + d] = std::max(all[2 + d], by.box[2 + d]);
    }
  return all;
}

using Gradients = Eigen::Matrix<double, 4, 2>;
} // namespace

BulkWatch::BulkWatch(const SceneView& scene, const ConversionRule& rule, const ElasticOfBody& elastic) : rule_(rule)
{
  const mesh::Mesh& mesh = scene.mesh;
  for (const mesh::Use use : {mesh::Use::plain, mesh::Use::points})
    for (const Index c : mesh.cells(use)) {
      if (c >= mesh.owned_cells() || !can_cover(scene, c)) continue;
      Watched cell{c, {}, Vector<2>::Zero(), elastic(mesh.body(c))};
      for (std::size_t a = 0; a < 4; ++a)
        cell.rows[a] = scene.halo.local(scene.node_rows[static_cast<std::size_t>(mesh.cell(c)[a])]);
      const Corners x = mesh.corners(c);
      const double near = 1e-9 * (x[2] - x[0]).norm();
      const bool box = is_box(x, near) && std::abs(x[1][1] - x[0][1]) < near && x[1][0] > x[0][0];
      if (box) cell.inverse = (x[2] - x[0]).cwiseInverse();
      const double exact = box ? 1.0 : 4.0;                   // bends of a slanted cell, amply
      double least = std::numeric_limits<double>::infinity(); // displacement gradient that may be too much
      if (rule.stretch) least = *rule.stretch;
      if (rule.stress) least = std::min(least, *rule.stress / cell.elastic.principal_stress(1.0, 1.0));
      append({cell.rows, 1, exact / std::min((x[1] - x[0]).squaredNorm(), (x[2] - x[3]).squaredNorm()),
              exact / std::min((x[3] - x[0]).squaredNorm(), (x[2] - x[1]).squaredNorm()), least * least});
      cells_.push_back(cell);
    }
}

void BulkWatch::append(const WatchRun& cell)
{
  const auto goes_on = [&cell](const WatchRun& run) {
    for (std::size_t a = 0; a < 4; ++a)
      if (cell.rows[a] != run.rows[a] + run.cells) return false;
    return true;
  };
  if (runs_.empty() || !goes_on(runs_.back())) {
    runs_.push_back(cell);
    return;
  }
  WatchRun& run = runs_.back(); // the most suspicious of all
  run.cells += cell.cells;
  run.along = std::max(run.along, cell.along);
  run.across = std::max(run.across, cell.across);
  run.limit = std::min(run.limit, cell.limit);
}

/// Strains are no larger than the displacement gradient: most cells are let off by it.
std::vector<Index> BulkWatch::asking(const mesh::Mesh& mesh, std::span<const double> local) const
{
  std::vector<std::size_t> suspicious;
  find_suspicious(this_processor(), runs_, local, suspicious);
  std::vector<Index> found;
  for (const std::size_t k : suspicious)
    if (may_ask(cells_[k], local.data()) && asks(mesh, cells_[k], local)) found.push_back(cells_[k].cell);
  return found;
}

void BulkWatch::leave_out(std::span<const Index> cells)
{
  std::vector<Watched> left;
  std::vector<WatchRun> all;
  std::swap(all, runs_);
  auto cell = cells_.cbegin();
  for (const WatchRun& run : all)
    for (Index k = 0; k < run.cells; ++k, ++cell) {
      if (std::ranges::binary_search(cells, cell->cell)) continue;
      left.push_back(*cell);
      append({cell->rows, 1, run.along, run.across, run.limit});
    }
  cells_ = std::move(left);
}

/// False only where no place of a box asks, whatever its rotation: with p, m = |(F11 +- F22, F21 -+ F12)| the principal
/// stretches are (p +- m) / 2, and p <= 1 + p^2 / 4, nearly alike.
bool BulkWatch::may_ask(const Watched& cell, const double* u) const
{
  if (cell.inverse[0] == 0.0) return true;
  std::array<const double*, 4> at{};
  for (std::size_t a = 0; a < 4; ++a) at[a] = u + 2 * cell.rows[a];
  std::array<std::array<double, 2>, 2> along{}, across{}; // d u / d x below and above, d u / d y left and right
  for (std::size_t d = 0; d < 2; ++d) {
    const double below = (at[1][d] - at[0][d]) * cell.inverse[0], above = (at[2][d] - at[3][d]) * cell.inverse[0];
    const double left = (at[3][d] - at[0][d]) * cell.inverse[1], right = (at[2][d] - at[1][d]) * cell.inverse[1];
    along[0][d] = 0.75 * below + 0.25 * above;
    along[1][d] = 0.25 * below + 0.75 * above;
    across[0][d] = 0.75 * left + 0.25 * right;
    across[1][d] = 0.25 * left + 0.75 * right;
  }
  bool any = false;
  const double lambda = cell.elastic.lambda(), mu = cell.elastic.mu();
  for (const auto& x : along)
    for (const auto& y : across) {
      const double sum = 2.0 + x[0] + y[1], turn = x[1] - y[0], gap = x[0] - y[1], shear = x[1] + y[0];
      const double p = 1.0 + 0.25 * (sum * sum + turn * turn), m2 = gap * gap + shear * shear;
      if (rule_.stretch) {
        const double left = 2.0 * (1.0 + *rule_.stretch) - p;
        any = any || left <= 0.0 || m2 >= left * left;
      }
      if (rule_.stress) {
        const double left = (*rule_.stress + (lambda + mu) * (2.0 - p)) / mu;
        any = any || left <= 0.0 || m2 >= left * left;
      }
    }
  return any;
}

bool BulkWatch::asks(const mesh::Mesh& mesh, const Watched& cell, std::span<const double> local) const
{
  const Corners corners = mesh.corners(cell.cell);
  Eigen::Matrix<double, 2, 4> u;
  for (int a = 0; a < 4; ++a)
    u.col(a) =
        Eigen::Map<const Vector<2>>(&local[2 * static_cast<std::size_t>(cell.rows[static_cast<std::size_t>(a)])]);
  for (int g = 0; g < 4; ++g) {
    const Gradients gradients =
        fem::map_point(corners, Vector<2>(g % 2 ? 0.5 : -0.5, g / 2 ? 0.5 : -0.5)).gradients.transpose();
    const auto [large, small] = principal_strains(u * gradients);
    if (rule_.stretch && large >= *rule_.stretch) return true;
    if (rule_.stress && cell.elastic.principal_stress(large, small) >= *rule_.stress) return true;
  }
  return false;
}

namespace {
/// That of a body's first patch, or what it begins with.
geom::LatticeAnchor lattice_of(const SceneView& scene, std::span<const geom::LatticeAnchor> lattices, Index body)
{
  for (const couple::Surroundings& around : scene.around)
    if (around.shape().body == body) return anchor_of(around.shape().lattice);
  return lattices[static_cast<std::size_t>(body)];
}
} // namespace

bool can_convert(const SceneView& scene, std::span<const geom::LatticeAnchor> lattices)
{
  bool any = false, left = false;
  for (Index c = 0; c < scene.mesh.owned_cells() && !any; ++c) {
    left = left || scene.mesh.use(c) != mesh::Use::covered;
    const geom::LatticeAnchor anchor = lattice_of(scene, lattices, scene.mesh.body(c));
    any = can_cover(scene, c) && is_divided(scene.mesh.corners(c), {anchor.corner, anchor.spacing, {1, 1}});
  }
  return any_rank(scene.mesh.comm(), any) || !any_rank(scene.mesh.comm(), left);
}

std::optional<UndividedCell> undivided_cell(const SceneView& scene, std::span<const geom::LatticeAnchor> lattices)
{
  const mesh::Mesh& mesh = scene.mesh;
  std::vector<Found> mine; // the first
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    const geom::LatticeAnchor anchor = lattice_of(scene, lattices, mesh.body(c));
    if (!can_cover(scene, c) || !is_box(mesh.corners(c), kFits * anchor.spacing)) continue;
    if (is_divided(mesh.corners(c), {anchor.corner, anchor.spacing, {1, 1}})) continue;
    if (mine.empty() || mesh.natural_cell(c) < mine.front().cell)
      mine.assign(1, found(mesh, c, box_of(mesh, c), anchor.spacing));
  }
  const std::vector<LayoutChange::Cover> all = gathered(mesh.comm(), mine);
  if (all.empty()) return std::nullopt;
  return UndividedCell{all.front().box.size(), all.front().spacing};
}

std::vector<LayoutChange::Cover> conversion(const SceneView& scene, BulkWatch& watch,
                                            std::span<const geom::LatticeAnchor> lattices,
                                            std::span<const double> local)
{
  const mesh::Mesh& mesh = scene.mesh;
  std::vector<Index> cells = watch.asking(mesh, local);
  if (!any_rank(mesh.comm(), !cells.empty())) return {};
  const HeldCells held(scene, true);
  std::vector<Asking> asking;
  for (const Index c : cells) {
    const geom::Box<2> box = box_of(mesh, c);
    const Vector<2> more = (watch.rule().margin - 0.5) * box.size(); // so that rounding leaves whole cells
    const Vector<2> lower = box.lower - more, upper = box.upper + more;
    asking.push_back({mesh.body(c), {lower[0], lower[1], upper[0], upper[1]}});
  }
  asking = gather_all(mesh.comm(), asking);
  const std::array<double, 4> all = around(asking);
  std::vector<Found> mine;
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    if (!can_cover(scene, c) || held.has(c)) continue;
    const geom::Box<2> box = box_of(mesh, c);
    const auto reaches = [&](const Asking& by) { return by.body == mesh.body(c) && overlap(by.box, box); };
    if (!overlap(all, box) || std::ranges::none_of(asking, reaches)) continue;
    const geom::LatticeAnchor anchor = lattice_of(scene, lattices, mesh.body(c));
    const geom::Lattice<2> lattice{anchor.corner, anchor.spacing, {1, 1}};
    if (is_divided(mesh.corners(c), lattice) && !meets_another(scene, mesh.body(c), box, anchor))
      mine.push_back(found(mesh, c, box, anchor.spacing));
  }
  std::vector<LayoutChange::Cover> covers = apart(gathered(mesh.comm(), mine));
  std::ranges::sort(cells);
  if (covers.empty()) watch.leave_out(cells);
  return covers;
}
} // namespace pdx::adapt
