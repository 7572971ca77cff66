#include "pdx/change/load_balance.hpp"

#include "pdx/base/exchange.hpp"

#include <algorithm>
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

/// Which part of a scene has the work of a Term; of contact between bodies it is the last.
std::size_t worker(const scene::Model& model, const field::Term& term)
{
  std::size_t p = 0;
  while (p + 1 < model.parts.size() && !model.parts[p]->works_in(term)) ++p;
  return p;
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
  const auto& parts = scene.model->parts;
  std::vector<double> work(parts.size(), 0.0); // this rank's time [ns a step]
  for (std::size_t k = 0; k < now_.size(); ++k)
    work[worker(*scene.model, *system.terms[k])] += 1e9 * (now_[k] - before_[k]) / steps_;

  std::vector<double> cost(static_cast<std::size_t>(mesh.owned_cells()), 0.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::vector<double> shares(cost.size(), 0.0);
    parts[p]->add_shares(shares);
    const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (std::size_t c = 0; c < cost.size(); ++c)
      if (shares[c] > 0.0) cost[c] += work[p] * shares[c] / all;
  }

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
