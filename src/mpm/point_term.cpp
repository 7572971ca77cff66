#include "pdx/mpm/point_term.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/exchange.hpp"
#include "shared_faces.hpp"

#include <algorithm>

namespace pdx::mpm {
namespace {
/// Cells of other ranks with a corner owned here.
template <int Dim>
std::vector<PointCell<Dim>> fetch_copies(const field::Rows& rows, std::span<const PointCell<Dim>> cells)
{
  const std::vector<PetscInt> first = first_rows(rows);
  int rank = 0;
  MPI_Comm_rank(rows.comm, &rank);
  std::vector<PointCell<Dim>> sent;
  std::vector<int> to;
  for (const PointCell<Dim>& cell : cells) {
    std::array<int, kCorners<Dim>> owners{};
    std::ranges::transform(cell.rows, owners.begin(), [&](PetscInt row) { return owner_of(row, first); });
    std::ranges::sort(owners);
    for (std::size_t k = 0; k < owners.size(); ++k) {
      if (owners[k] == rank || (k > 0 && owners[k] == owners[k - 1])) continue;
      sent.push_back(cell);
      to.push_back(owners[k]);
    }
  }
  return exchange(rows.comm, sort_by_rank<PointCell<Dim>>(sent, to, static_cast<int>(first.size()))).records;
}

/// Cells of a run, one by one.
template <int Dim> std::vector<CellRows<Dim>> cells_of(const CellRun<Dim>& run)
{
  std::vector<CellRows<Dim>> cells(static_cast<std::size_t>(run.cells));
  for (std::size_t k = 0; k < cells.size(); ++k) cells[k] = run.rows(static_cast<Index>(k));
  return cells;
}
} // namespace

template <int Dim>
PointTerm<Dim>::PointTerm(const field::Rows& rows, std::vector<PointCell<Dim>> cells,
                          std::vector<BodyMaterial> materials, double viscosity)
    : cells_(std::move(cells)), copies_(fetch_copies<Dim>(rows, cells_)), materials_(std::move(materials)),
      patterns_(materials_), viscosity_(viscosity)
{
  for (const PointCell<Dim>& cell : cells_) points_ += std::popcount(cell.points);
}

template <int Dim> void PointTerm<Dim>::needed_rows(std::vector<PetscInt>& rows) const
{
  for (const auto* cells : {&cells_, &copies_})
    for (const PointCell<Dim>& cell : *cells) rows.insert(rows.end(), cell.rows.begin(), cell.rows.end());
}

template <int Dim> void PointTerm<Dim>::bind(const field::RowHalo& halo)
{
  halo_ = &halo;
  owned_rows_ = halo.rows().owned();
  const auto localised = [&](const std::vector<PointCell<Dim>>& cells) {
    std::vector<LocalCell<Dim>> local;
    for (const PointCell<Dim>& cell : cells) {
      local.push_back({cell.body, {}, cell.points});
      std::ranges::transform(cell.rows, local.back().rows.begin(), [&](PetscInt row) { return halo.local(row); });
    }
    return local;
  };
  local_ = localised(cells_);
  const std::vector<LocalCell<Dim>> copies = localised(copies_);
  own_ = CellBlocks<Dim>(local_, owned_rows_, materials_, patterns_);
  copied_ = CellBlocks<Dim>(copies, owned_rows_, materials_, patterns_);
  local_.insert(local_.end(), copies.begin(), copies.end());
}

template <int Dim> void PointTerm<Dim>::add_residual(std::span<const double> u, std::span<double> r) const
{
  static Event event("mpm_force");
  const Timed timed(event);
  const NodeFields fields{u.data(), nullptr, r.data(), owned_rows_, skips_ ? &skipped_ : nullptr};
  passed_ += static_cast<std::int64_t>(local_.size());
  for (const CellBlocks<Dim>* cells : {&own_, &copied_})
    for (const auto& block : cells->blocks()) {
      const BodyMaterial& body = material(block.body);
      add_run_forces<Dim>(processor_, body, *block.points, block.runs, fields);
      add_cell_forces<Dim>(processor_, body, *block.points, block.cells, fields);
    }
}

template <int Dim>
double PointTerm<Dim>::add_viscous(double b, std::span<const double> u, std::span<const double> v,
                                   std::span<double> r) const
{
  static Event event("mpm_viscous");
  const Timed timed(event);
  std::int64_t resting = 0; // counted where forces are elastic
  const NodeFields fields{u.data(), v.data(), r.data(), owned_rows_, skips_ ? &resting : nullptr};
  double power = 0.0;
  for (const CellBlocks<Dim>* cells : {&own_, &copied_})
    for (const auto& block : cells->blocks()) {
      const BodyMaterial& body = material(block.body);
      const double lost = add_run_viscous<Dim>(processor_, body, *block.points, b, block.runs, fields) +
                          add_cell_viscous<Dim>(processor_, body, *block.points, b, block.cells, fields);
      if (cells == &own_) power += lost;
    }
  return power;
}

template <int Dim>
void PointTerm<Dim>::add_damping(std::span<const double> u, std::span<const double> v, std::span<double> r) const
{
  add_viscous(viscosity_, u, v, r);
}

template <int Dim> double PointTerm<Dim>::energy(std::span<const double> u) const
{
  static Event event("mpm_energy");
  const Timed timed(event);
  double sum = 0.0;
  for (const auto& block : own_.blocks()) {
    const auto energy_of = [&](std::span<const CellRows<Dim>> cells) {
      return cell_energy<Dim>(processor_, material(block.body), *block.points, cells, u.data());
    };
    sum += energy_of(block.cells);
    for (const CellRun<Dim>& run : block.runs) sum += energy_of(cells_of<Dim>(run));
  }
  return sum;
}

template <int Dim> void PointTerm<Dim>::linearise(std::span<const double> u)
{
  displacement_.assign(u.begin(), u.end());
}

template <int Dim> void PointTerm<Dim>::couplings(field::Couplings& couplings, bool) const
{
  std::vector<std::vector<Index>> neighbours(static_cast<std::size_t>(owned_rows_));
  for (const LocalCell<Dim>& cell : local_)
    for (const Index row : cell.rows) {
      if (row >= owned_rows_) continue;
      std::vector<Index>& of_row = neighbours[static_cast<std::size_t>(row)];
      for (const Index column : cell.rows) {
        if (column == row || std::ranges::find(of_row, column) != of_row.end()) continue;
        of_row.push_back(column);
        couplings.add(row, column);
      }
    }
}

template <int Dim> void PointTerm<Dim>::add_jacobian(field::BlockAdder& adder, bool) const
{
  static Event event("mpm_jacobian");
  const Timed timed(event);
  for (const LocalCell<Dim>& cell : local_) {
    const CellMatrix<Dim> k =
        cell_tangent<Dim>(material(cell.body), pattern(cell), corner_values<Dim>(cell, displacement_));
    adder.add(cell.rows, cell.rows, {k.data(), static_cast<std::size_t>(k.size())});
  }
}

template <int Dim> void PointTerm<Dim>::add_mass(std::span<double> mass) const
{
  for (const LocalCell<Dim>& cell : local_) {
    const CellPoints<Dim>& points = pattern(cell);
    for (std::size_t a = 0; a < cell.rows.size(); ++a)
      if (const Index row = cell.rows[a]; row < owned_rows_)
        mass[static_cast<std::size_t>(row)] +=
            material(cell.body).elastic.density * points.shares[static_cast<Eigen::Index>(a)];
  }
}

template class PointTerm<2>;
template class PointTerm<3>;
} // namespace pdx::mpm
