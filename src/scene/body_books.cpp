#include "pdx/scene/body_books.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/couple/contact_books.hpp"
#include "pdx/solve/stable_step.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pdx::scene {
namespace {
constexpr double kAlike = 1e-9; // of velocities: bodies that move alike do not meet
} // namespace

template <int Dim>
BodyBooks<Dim>::BodyBooks(const field::System& system, BodyRows rows, const couple::ContactBooks* contact)
    : system_(system), rows_(std::move(rows)), contact_(contact), mass_(solve::lumped_mass(system)),
      ties_(solve::ties_of(system))
{
  std::ranges::sort(ties_, {}, &field::Tie::set);
  const std::vector<double> rest(Dim * mass_.size(), 0.0);
  const std::span<const double> v = system.initial_velocity.empty() ? rest : system.initial_velocity;
  start_ = sums(rest, v);
  double whole = 0.0;
  for (const double m : start_.mass) whole += m;
  middle_ = start_.moment / whole;
}

template <int Dim> Vector<Dim> BodyBooks<Dim>::value(std::span<const double> values, std::size_t row) const
{
  Vector<Dim> x = Eigen::Map<const Vector<Dim>>(&values[Dim * row]);
  const auto tie = std::ranges::lower_bound(ties_, static_cast<Index>(row), {}, &field::Tie::set);
  if (tie == ties_.end() || tie->set != static_cast<Index>(row)) return x;
  return Eigen::Map<const Vector<Dim>>(&values[Dim * static_cast<std::size_t>(tie->row)]) + tie->factor * x;
}

template <int Dim>
auto BodyBooks<Dim>::sums(std::span<const double> local, std::span<const double> velocity) const -> Sums
{
  const std::size_t bodies = rows_.names.size();
  std::vector<double> all(bodies * (Dim + 1) + Dim + 3, 0.0);
  double* const moment = &all[bodies * (Dim + 1)];
  for (std::size_t row = 0; row < mass_.size(); ++row) {
    const auto b = static_cast<std::size_t>(rows_.of_row[row]);
    const Vector<Dim> x = Eigen::Map<const Vector<Dim>>(&system_.coordinates[Dim * row]) + value(local, row),
                      p = mass_[row] * value(velocity, row);
    Vector<3> arm = Vector<3>::Zero(), push = Vector<3>::Zero();
    arm.head<Dim>() = x - middle_;
    push.head<Dim>() = p;
    const Vector<3> angular = arm.cross(push);
    all[b * (Dim + 1)] += mass_[row];
    for (int d = 0; d < Dim; ++d) {
      all[b * (Dim + 1) + 1 + static_cast<std::size_t>(d)] += p[d];
      moment[d] += mass_[row] * x[d];
    }
    for (int d = 0; d < 3; ++d) moment[Dim + d] += angular[d];
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, system_.rows.comm);
  Sums sums;
  for (std::size_t b = 0; b < bodies; ++b) {
    sums.mass.push_back(all[b * (Dim + 1)]);
    sums.momentum.push_back(Eigen::Map<const Vector<Dim>>(&all[b * (Dim + 1) + 1]));
  }
  sums.moment = Eigen::Map<const Vector<Dim>>(moment);
  sums.angular = Eigen::Map<const Vector<3>>(moment + Dim);
  return sums;
}

template <int Dim> double BodyBooks<Dim>::kinetic(std::span<const double> velocity, Index rows, Index end) const
{
  double sum = 0.0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
    if (rows_.of_row[row] < end) sum += 0.5 * mass_[row] * value(velocity, row).squaredNorm();
  return sum;
}

template <int Dim> std::vector<double> BodyBooks<Dim>::start() const
{
  std::vector<double> all;
  for (std::size_t b = 0; b < start_.mass.size(); ++b) {
    all.push_back(start_.mass[b]);
    all.insert(all.end(), start_.momentum[b].begin(), start_.momentum[b].end());
  }
  all.insert(all.end(), middle_.begin(), middle_.end());
  return all;
}

template <int Dim> void BodyBooks<Dim>::begin_with(std::span<const double> start)
{
  for (std::size_t b = 0; b < start_.mass.size(); ++b) {
    start_.mass[b] = start[b * (Dim + 1)];
    start_.momentum[b] = Eigen::Map<const Vector<Dim>>(&start[b * (Dim + 1) + 1]);
  }
  middle_ = Eigen::Map<const Vector<Dim>>(&start[start_.mass.size() * (Dim + 1)]);
}

template <int Dim> std::vector<io::Column> BodyBooks<Dim>::more_columns() const
{
  std::vector<io::Column> columns;
  for (std::size_t d = 0; d < Dim; ++d) columns.push_back({fmt::format("momentum_{}", kAxes[d]), "kg m/s"});
  for (std::size_t d = Dim == 2 ? 2 : 0; d < 3; ++d)
    columns.push_back({fmt::format("angular_momentum_{}", kAxes[d]), "kg m^2/s"});
  for (const std::string& name : rows_.names)
    for (std::size_t d = 0; d < Dim; ++d) columns.push_back({fmt::format("velocity_{}_{}", name, kAxes[d]), "m/s"});
  if (!contact_) return columns;
  for (const couple::ContactBooks::Pair& pair : contact_->pairs())
    for (const auto& [what, unit] : {std::pair{"force", "N"}, std::pair{"impulse", "N s"}})
      for (std::size_t d = 0; d < Dim; ++d)
        columns.push_back({fmt::format("contact_{}_{}_{}_{}", pair.first, pair.second, what, kAxes[d]), unit});
  return columns;
}

template <int Dim>
void BodyBooks<Dim>::add_more(std::span<const double> local, std::span<const double> velocity,
                              std::vector<double>& row) const
{
  const Sums now = sums(local, velocity);
  Vector<Dim> whole = Vector<Dim>::Zero();
  for (const Vector<Dim>& p : now.momentum) whole += p;
  row.insert(row.end(), whole.begin(), whole.end());
  row.insert(row.end(), now.angular.begin() + (Dim == 2 ? 2 : 0), now.angular.end());
  for (std::size_t b = 0; b < now.mass.size(); ++b) {
    const Vector<Dim> mean = now.momentum[b] / now.mass[b];
    row.insert(row.end(), mean.begin(), mean.end());
  }
  if (!contact_) return;
  std::vector<double> pushes;
  for (std::size_t pair = 0; pair < contact_->pairs().size(); ++pair)
    for (const std::array<double, 3>& push : {contact_->force(pair), contact_->impulse(pair)})
      pushes.insert(pushes.end(), push.begin(), push.begin() + Dim);
  MPI_Allreduce(MPI_IN_PLACE, pushes.data(), static_cast<int>(pushes.size()), MPI_DOUBLE, MPI_SUM, system_.rows.comm);
  row.insert(row.end(), pushes.begin(), pushes.end());
}

template <int Dim>
void BodyBooks<Dim>::add_results(std::span<const double> local, std::span<const double> velocity,
                                 nlohmann::ordered_json& results) const
{
  const Sums now = sums(local, velocity);
  double thrown = 0.0;
  Vector<Dim> change = Vector<Dim>::Zero();
  for (std::size_t b = 0; b < start_.momentum.size(); ++b) {
    thrown += start_.momentum[b].norm();
    change += now.momentum[b] - start_.momentum[b];
  }
  const bool held = any_rank(system_.rows.comm, !system_.prescribed.components.empty() || !system_.drives.empty() ||
                                                    !system_.rollers.empty() || !system_.supports.empty());
  if (!held && thrown > 0.0) results["momentum_error_ratio"] = change.norm() / thrown;
  if (start_.momentum.size() != 2) return;
  const auto velocity_of = [](const Sums& sums, std::size_t b) -> Vector<Dim> {
    return sums.momentum[b] / sums.mass[b];
  };
  const Vector<Dim> before = velocity_of(start_, 0) - velocity_of(start_, 1),
                    after = velocity_of(now, 0) - velocity_of(now, 1);
  if (before.norm() <= kAlike * (velocity_of(start_, 0).norm() + velocity_of(start_, 1).norm())) return;
  results["rebound_ratio"] = -after.dot(before) / before.squaredNorm();
}

template class BodyBooks<2>;
template class BodyBooks<3>;
} // namespace pdx::scene
