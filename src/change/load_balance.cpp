#include "pdx/change/load_balance.hpp"

#include "pdx/base/exchange.hpp"
#include "pdx/scene/point_body.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace pdx::change {
namespace {
constexpr double kMostCost = 1e7;  // ns a step that a cell may be said to take
constexpr double kForecast = 1.15; // over its forecast, above which a partition is worth another try

struct CellTime {
  Index cell; ///< natural number
  int cost;   ///< [ns]
};

/// Does the work of a Term lie in elements? Else particles have it, carried bonds and clouds included.
bool is_of_elements(const scene::Standing& scene, const field::Term& term)
{
  return scene.d && (&term == scene.d->elements || &term == scene.d->cut_elements);
}

/// Or in material points?
bool is_of_points(const scene::Standing& scene, const field::Term& term)
{
  if (scene.d) return &term == scene.d->points;
  return scene.points != nullptr; // contact between bodies besides
}

/// How many of a plan each owned cell of the mesh holds.
template <int Dim>
void count_points(const scene::PointPlan<Dim>& plan, const mesh::Mesh& mesh, std::vector<double>& counts)
{
  for (Index c = 0; c < mesh.owned_cells(); ++c) {
    const Index number = mesh.natural_cell(c) - plan.first_cell;
    if (number < 0 || mesh.use(c) == mesh::Use::covered) continue;
    const auto& column = plan.cells[static_cast<std::size_t>(number)];
    const mpm::Body<Dim>& of = plan.bodies[static_cast<std::size_t>(column.body)];
    for (const Index layer : plan.cell_layers(column)) {
      Site<Dim> at{};
      at[0] = column.at[0];
      at[1] = column.at[1];
      if constexpr (Dim == 3) at[2] = layer;
      counts[static_cast<std::size_t>(c)] += std::popcount(of.points_in(at));
    }
  }
}

std::vector<double> points_in_cells(const scene::Standing& scene)
{
  std::vector<double> counts(static_cast<std::size_t>(scene.mesh->owned_cells()), 0.0);
  if (scene.d && scene.d->points)
    count_points(*scene.d->point_plan, *scene.mesh, counts);
  else if (const auto* plane = dynamic_cast<const scene::PointBody<2>*>(scene.points))
    count_points(plane->plan, *scene.mesh, counts);
  else if (const auto* space = dynamic_cast<const scene::PointBody<3>*>(scene.points))
    count_points(space->plan, *scene.mesh, counts);
  return counts;
}
} // namespace

bool LoadBalance::due(const solve::TimeDriver& driver)
{
  if (threshold_ <= 0.0 || driver.step() < since_ + interval_) return false;
  before_ = std::move(now_);
  now_ = busy(driver);
  before_.resize(now_.size(), 0.0);
  const double time =
      std::accumulate(now_.begin(), now_.end(), 0.0) - std::accumulate(before_.begin(), before_.end(), 0.0);
  double most = time, sum = time;
  int ranks = 1;
  MPI_Comm_size(comm_, &ranks);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, comm_);
  MPI_Allreduce(MPI_IN_PLACE, &sum, 1, MPI_DOUBLE, MPI_SUM, comm_);
  imbalance_ = sum > 0.0 ? most * ranks / sum : 1.0;
  steps_ = driver.step() - since_;
  since_ = driver.step();
  above_ = imbalance_ > limit_ ? above_ + 1 : 0;
  return above_ >= 2;
}

std::vector<double> LoadBalance::busy(const solve::TimeDriver& driver) const
{
  const std::span<const double> mine = driver.moving().busy();
  std::vector<double> all(mine.begin(), mine.end());
  all.resize(std::max(all.size(), gone_.size()), 0.0); // a driver that has not stepped knows of no Term
  for (std::size_t k = 0; k < gone_.size(); ++k) all[k] += gone_[k];
  return all;
}

mesh::MeasuredCosts LoadBalance::costs(const scene::Standing& scene, const solve::TimeDriver& driver) const
{
  const mesh::Mesh& mesh = *scene.mesh;
  const field::System& system = driver.moving().system;
  double elements = 0.0, points = 0.0, particles = 0.0; // this rank's time [ns a step]
  for (std::size_t k = 0; k < now_.size(); ++k) {
    const field::Term& term = *system.terms[k];
    double& of = is_of_elements(scene, term) ? elements : is_of_points(scene, term) ? points : particles;
    of += 1e9 * (now_[k] - before_[k]) / steps_;
  }

  std::vector<double> cost(static_cast<std::size_t>(mesh.owned_cells()), 0.0);
  const auto is_element = [&](Index c) {
    return scene.d && mesh.use(c) != mesh::Use::covered && mesh.use(c) != mesh::Use::points;
  };
  double cells = 0.0;
  for (Index c = 0; c < mesh.owned_cells(); ++c) cells += is_element(c);
  for (Index c = 0; c < mesh.owned_cells(); ++c)
    if (is_element(c)) cost[static_cast<std::size_t>(c)] = elements / cells;
  const std::vector<double> of_points = points_in_cells(scene);
  const double all_points = std::accumulate(of_points.begin(), of_points.end(), 0.0);
  for (std::size_t c = 0; c < cost.size(); ++c)
    if (of_points[c] > 0.0) cost[c] += points * of_points[c] / all_points;
  for (const pd::Particle& p : scene.model->particles)
    cost[static_cast<std::size_t>(p.cell)] += particles / static_cast<double>(scene.model->particles.size());

  Parcels<CellTime> out;
  int ranks = 1, rank = 0;
  MPI_Comm_size(comm_, &ranks);
  MPI_Comm_rank(comm_, &rank);
  out.counts.assign(static_cast<std::size_t>(ranks), 0);
  out.counts[0] = mesh.owned_cells();
  for (Index c = 0; c < mesh.owned_cells(); ++c)
    out.records.push_back({mesh.natural_cell(c), static_cast<int>(std::clamp(
                                                     std::round(cost[static_cast<std::size_t>(c)]), 1.0, kMostCost))});
  mesh::MeasuredCosts all;
  if (rank == 0) all.of_cell.assign(static_cast<std::size_t>(mesh.global_cells()), 1);
  for (const CellTime& time : exchange(comm_, out).records)
    all.of_cell[static_cast<std::size_t>(time.cell)] = time.cost;
  return all;
}

void LoadBalance::leave(const solve::TimeDriver& driver) { gone_ = busy(driver); }

void LoadBalance::changed(const solve::TimeDriver& driver, double forecast)
{
  ++changes_;
  interval_ *= 2;
  limit_ = std::max(threshold_, kForecast * forecast);
  since_ = driver.step();
  above_ = 0;
  before_.clear();
  now_ = busy(driver);
}
} // namespace pdx::change
