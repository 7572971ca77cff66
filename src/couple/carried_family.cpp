#include "pdx/couple/carried_family.hpp"

#include "pdx/base/events.hpp"
#include "pdx/couple/carried_runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace pdx::couple {
/// Dense tangent of consecutive bonds that share their first point: one small matrix per insertion.
template <int Dim> struct CarriedFamily<Dim>::Panel {
  std::vector<Index> rows;
  std::vector<double> values;

  std::size_t place(Index row)
  {
    const auto at = std::find(rows.begin(), rows.end(), row);
    if (at == rows.end()) rows.push_back(row);
    return static_cast<std::size_t>(at - rows.begin());
  }
  void size_values() { values.assign(rows.size() * rows.size() * Dim * Dim, 0.0); }
  void add(std::size_t r, std::size_t c, double factor, const Tensor<Dim>& block)
  {
    const std::size_t width = rows.size() * Dim;
    for (std::size_t a = 0; a < Dim; ++a)
      for (std::size_t b = 0; b < Dim; ++b)
        values[(r * Dim + a) * width + c * Dim + b] +=
            factor * block(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  }
};

template <int Dim>
CarriedFamily<Dim>::CarriedFamily(const field::Rows& rows, CarriedPoints<Dim> points,
                                  std::vector<CarriedBond<Dim>> bonds, law::Kinematics kinematics, bool symmetric)
    : rows_(rows), points_(std::move(points)), bonds_(std::move(bonds)), kinematics_(kinematics), symmetric_(symmetric)
{
  rest_.reserve(bonds_.size());
  gone_.reserve(bonds_.size());
  for (const CarriedBond<Dim>& bond : bonds_) {
    const double length = bond.xi.norm();
    rest_.push_back({bond.xi / length, length});
    gone_.push_back(bond.cut);
    hands_ = hands_ || bond.handed != 0.0;
  }
  saved_ = gone_;
}

template <int Dim> CarriedFamily<Dim>::~CarriedFamily() = default;

template <int Dim> void CarriedFamily<Dim>::needed_rows(std::vector<PetscInt>& rows) const
{
  rows.insert(rows.end(), points_.all_rows().begin(), points_.all_rows().end());
}

template <int Dim>
Vector<Dim> CarriedFamily<Dim>::stretch_vector(const CarriedBond<Dim>& bond, std::span<const double> d) const
{
  Vector<Dim> eta;
  for (std::size_t k = 0; k < Dim; ++k)
    eta[static_cast<Eigen::Index>(k)] =
        d[static_cast<std::size_t>(bond.b) * Dim + k] - d[static_cast<std::size_t>(bond.a) * Dim + k];
  return eta;
}

/// At displacements d of the points.
template <int Dim>
law::BondState<Dim> CarriedFamily<Dim>::state_of(std::size_t number, std::span<const double> d,
                                                 law::Kinematics kinematics) const
{
  return state_of(number, stretch_vector(bonds_[number], d), kinematics);
}

template <int Dim>
law::BondState<Dim> CarriedFamily<Dim>::state_of(std::size_t number, const Vector<Dim>& eta,
                                                 law::Kinematics kinematics) const
{
  const Rest& rest = rest_[number];
  if (kinematics == law::Kinematics::finite)
    return law::finite_state<Dim>(bonds_[number].xi, rest.length, eta, free_strain(number));
  return {rest.along.dot(eta) / rest.length - free_strain(number), rest.along, 0.0};
}

/// A bond that several ranks evaluate is counted by the owner of the first row at its first end.
template <int Dim> double CarriedFamily<Dim>::energy(std::span<const double> u) const
{
  double total = 0.0;
  const auto add = [&](std::size_t number, const Vector<Dim>& eta) {
    const CarriedBond<Dim>& bond = bonds_[number];
    if (gone_[number] || !counted(bond)) return;
    total += law::bond_energy(bond.kappa, rest_[number].length, state_of(number, eta, kinematics_).stretch);
  };
  if (!runs_) {
    points_.spread(u, spread_);
    for (std::size_t number = 0; number < bonds_.size(); ++number) add(number, stretch_vector(bonds_[number], spread_));
    return total;
  }
  const auto add_one = [&](std::size_t number) {
    add(number, points_.displacement(bonds_[number].b, u) - points_.displacement(bonds_[number].a, u));
  };
  refresh_lanes();
  for (const CarriedLanes<Dim>& lanes : lanes_) std::ranges::for_each(lanes.numbers(), add_one);
  std::ranges::for_each(others_, add_one);
  return total + runs_->energy(processor_, kinematics_ == law::Kinematics::finite, u);
}

template <int Dim>
void CarriedFamily<Dim>::add_energy_density(std::span<const double> u, std::span<double> density) const
{
  points_.spread(u, spread_);
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    const CarriedBond<Dim>& bond = bonds_[number];
    const Index particle = points_.rows(bond.a).front();
    if (gone_[number] || bond.energy_share == 0.0 || particle >= rows_.owned()) continue;
    const double stretch = state_of(number, spread_, kinematics_).stretch;
    density[static_cast<std::size_t>(particle)] += 0.5 * law::bond_energy(bond.kappa, bond.energy_share, stretch);
  }
}

template <int Dim> void CarriedFamily<Dim>::linearise(std::span<const double> u) { points_.spread(u, state_); }

/// Visits the bonds in groups [begin, end) that share point a, with the rows at their ends and where their forces act.
template <int Dim> template <class Visit> void CarriedFamily<Dim>::for_each_group(Visit&& visit) const
{
  Panel panel;
  for (std::size_t begin = 0, end = 0; begin < bonds_.size(); begin = end) {
    panel.rows.clear();
    for (end = begin; end < bonds_.size() && bonds_[end].a == bonds_[begin].a; ++end)
      for (const Index point : {bonds_[end].a, bonds_[end].b, bonds_[end].force_a, bonds_[end].force_b})
        for (const Index row : points_.rows(point)) panel.place(row);
    visit(panel, begin, end);
  }
}

template <int Dim> void CarriedFamily<Dim>::couplings(field::Couplings& couplings, bool) const
{
  std::map<Index, std::vector<Index>> columns; // of owned rows, with repeats
  for_each_group([&](const Panel& panel, std::size_t, std::size_t) {
    for (const Index row : panel.rows) {
      if (row >= rows_.owned()) continue;
      auto& list = columns[row];
      list.insert(list.end(), panel.rows.begin(), panel.rows.end());
    }
  });
  for (auto& [row, list] : columns) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (const Index column : list) couplings.add(row, column);
  }
}

/// d(force rows)/d(displacement rows): with eta = sum_k g_k u_k the block of rows (k, l) is gF_k g_l K.
template <int Dim> void CarriedFamily<Dim>::add_jacobian(field::BlockAdder& adder, bool) const
{
  for_each_group([&](Panel& panel, std::size_t begin, std::size_t end) {
    panel.size_values();
    for (std::size_t k = begin; k < end; ++k) {
      if (gone_[k]) continue;
      const CarriedBond<Dim>& bond = bonds_[k];
      const law::BondState<Dim> state = kinematics_ == law::Kinematics::finite
                                            ? state_of(k, state_, kinematics_)
                                            : law::BondState<Dim>{0.0, rest_[k].along, 0.0};
      const Tensor<Dim> stiffness = law::bond_stiffness<Dim>(bond.kappa, rest_[k].length, state);
      for (const auto& [force_point, force_sign] : {std::pair{bond.force_a, -1.0}, std::pair{bond.force_b, 1.0}})
        for (std::size_t f = 0; f < points_.rows(force_point).size(); ++f)
          for (const auto& [point, sign] : {std::pair{bond.a, -1.0}, std::pair{bond.b, 1.0}})
            for (std::size_t c = 0; c < points_.rows(point).size(); ++c)
              panel.add(panel.place(points_.rows(force_point)[f]), panel.place(points_.rows(point)[c]),
                        force_sign * points_.weights(force_point)[f] * sign * points_.weights(point)[c], stiffness);
    }
    adder.add(panel.rows, panel.rows, panel.values);
  });
}

/// What breaks later leaves the bound as it is: a scene that goes on and one that is made anew, before it is told what
/// broke, take the same steps.
template <int Dim> void CarriedFamily<Dim>::add_stiffness_bound(std::span<double> blocks) const
{
  if (!symmetric_) throw std::logic_error("carried bonds: no bound on the stiffness, the tangent is not symmetric");
  constexpr std::size_t size = Dim * Dim;
  if (stiffness_bound_.empty()) {
    std::vector<double> all(blocks.size(), 0.0);
    work_out_bound(all);
    for (const Index row : used_)
      if (row < rows_.owned())
        stiffness_bound_.insert(stiffness_bound_.end(), all.begin() + std::ptrdiff_t{row} * Dim * Dim,
                                all.begin() + (std::ptrdiff_t{row} + 1) * Dim * Dim);
  }
  for (std::size_t k = 0; k * size < stiffness_bound_.size(); ++k) // owned rows are the first
    for (std::size_t i = 0; i < size; ++i)
      blocks[static_cast<std::size_t>(used_[k]) * size + i] += stiffness_bound_[k * size + i];
}

template <int Dim> void CarriedFamily<Dim>::work_out_bound(std::span<double> blocks) const
{
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    if (gone_[number]) continue;
    const CarriedBond<Dim>& bond = bonds_[number];
    const auto& [along, length] = rest_[number];
    const Tensor<Dim> stiffness = bond.kappa / length * along * along.transpose();
    for (const Index point : {bond.a, bond.b}) {
      const std::span<const double> weights = points_.tied_weights(point);
      double sum = 0.0;
      for (const double c : weights) sum += std::abs(c);
      for (std::size_t k = 0; k < weights.size(); ++k) {
        const Index row = points_.rows(point)[k];
        if (row >= rows_.owned()) continue;
        double* block = blocks.data() + static_cast<std::size_t>(row) * Dim * Dim;
        Eigen::Map<Tensor<Dim>>{block} += 2.0 * sum * std::abs(weights[k]) * stiffness; // symmetric: in either order
      }
    }
  }
}

template <int Dim>
template <class Visit>
void CarriedFamily<Dim>::for_each_overstretched(std::span<const double> u, std::span<const pd::BreakRule> rules,
                                                Visit&& visit) const
{
  points_.spread(u, spread_);
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    const CarriedBond<Dim>& bond = bonds_[number];
    if (gone_[number] || bond.no_fail) continue;
    const pd::BreakRule& rule = rules[static_cast<std::size_t>(bond.patch)];
    const double s = state_of(number, spread_, rule.kinematics).stretch;
    if (s > rule.critical_stretch * bond.stretch) visit(number, s);
  }
}

template <int Dim>
pd::Broken CarriedFamily<Dim>::break_bonds(std::span<const double> u, std::span<const pd::BreakRule> rules,
                                           field::ForceLosses* losses)
{
  pd::Broken broken;
  for_each_overstretched(u, rules, [&](std::size_t number, double stretch) {
    const CarriedBond<Dim>& bond = bonds_[number];
    gone_[number] = 1;
    ++revision_;
    if (losses) note_force(number, rules[static_cast<std::size_t>(bond.patch)].kinematics, *losses);
    if (counted(bond)) broken += {1, law::bond_energy(bond.kappa, rest_[number].length, stretch)};
  });
  return broken;
}

/// What a bond pulls the owned rows of its hosts with, at the displacement spread last.
template <int Dim>
void CarriedFamily<Dim>::note_force(std::size_t number, law::Kinematics kinematics, field::ForceLosses& losses) const
{
  const CarriedBond<Dim>& bond = bonds_[number];
  const law::BondState<Dim> state = state_of(number, spread_, kinematics);
  const Vector<Dim> pull = bond.kappa * state.stretch * state.direction;
  for (const auto& [point, sign] : {std::pair{bond.force_a, -1.0}, std::pair{bond.force_b, 1.0}})
    for (std::size_t k = 0; k < points_.rows(point).size(); ++k) {
      const Index row = points_.rows(point)[k];
      if (row >= rows_.owned()) continue;
      for (int d = 0; d < Dim; ++d) losses.push_back({row * Dim + d, sign * points_.weights(point)[k] * pull[d]});
    }
}

template <int Dim> void CarriedFamily<Dim>::move_rows(const field::Rows& rows, std::span<const Index> now, Index patch)
{
  rows_ = rows;
  if (!limits_.empty() && !bonds_.empty())
    limits_.assign(static_cast<std::size_t>(patch) + 1, limits_[static_cast<std::size_t>(bonds_.front().patch)]);
  for (CarriedBond<Dim>& bond : bonds_) {
    if (bond.patch == patch) break; // as all of them
    bond.patch = patch;
  }
  moved_to_ = patch;
  if (runs_) runs_->number(rows.owned(), patch);
  const auto at = [&now](Index row) { return now[static_cast<std::size_t>(row)]; };
  if (now.empty() || std::ranges::all_of(used_, [&](Index row) { return at(row) == row; })) return;
  points_.move_rows(now);
  for (CarriedLanes<Dim>& lanes : lanes_) lanes.move_rows(now);
  if (runs_) runs_->move_rows(now);
  for (auto& [row, volume] : volumes_) row = at(row);
  for (Index& row : used_) row = at(row);
}

template <int Dim> void CarriedFamily<Dim>::watch(std::span<const pd::BreakRule> rules)
{
  const auto p = static_cast<std::size_t>(std::max(moved_to_, 0));
  const bool known = moved_to_ >= 0 && p < limits_.size() && limits_[p] == rules[p].critical_stretch;
  if (!known) lanes_revision_ = -1;
  limits_.clear();
  for (const pd::BreakRule& rule : rules) limits_.push_back(rule.critical_stretch);
}

template <int Dim>
void CarriedFamily<Dim>::overstretched(std::span<const double> u, std::span<const pd::BreakRule> rules,
                                       std::vector<double>& ratios) const
{
  for_each_overstretched(u, rules, [&](std::size_t number, double stretch) {
    const CarriedBond<Dim>& bond = bonds_[number];
    const double critical = rules[static_cast<std::size_t>(bond.patch)].critical_stretch * bond.stretch;
    if (counted(bond)) ratios.push_back(stretch / critical);
  });
}

/// Of the particles that have bonds here, summed up anew only after bonds broke.
template <int Dim> const std::vector<std::pair<Index, pd::BondedVolume>>& CarriedFamily<Dim>::volumes() const
{
  if (volumes_revision_ == revision_) return volumes_;
  volumes_revision_ = revision_;
  volumes_.clear();
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    const CarriedBond<Dim>& bond = bonds_[number];
    if (bond.volume == 0.0 || !counted(bond)) continue;
    const Index row = points_.rows(bond.a).front();
    if (volumes_.empty() || volumes_.back().first != row) volumes_.push_back({row, {}});
    pd::BondedVolume& volume = volumes_.back().second;
    volume.whole += bond.volume;
    if (!bond.cut) volume.start += bond.volume;
    if (!gone_[number]) volume.now += bond.volume;
  }
  return volumes_;
}

namespace {
void add_up(pd::BondedVolume& sum, const pd::BondedVolume& more)
{
  sum.whole += more.whole;
  sum.start += more.start;
  sum.now += more.now;
}
} // namespace

template <int Dim> void CarriedFamily<Dim>::add_bonded_volume(std::span<pd::BondedVolume> sums) const
{
  for (const auto& [row, volume] : volumes()) add_up(sums[static_cast<std::size_t>(row)], volume);
}

template <int Dim> void CarriedFamily<Dim>::add_bonded_volume(Index row, pd::BondedVolume& sum) const
{
  const auto of_row = std::ranges::equal_range(volumes(), row, {}, [](const auto& entry) { return entry.first; });
  for (const auto& entry : of_row) add_up(sum, entry.second);
}

template <int Dim> void CarriedFamily<Dim>::add_thinned(std::vector<Index>& rows) const
{
  for (const auto& [row, volume] : volumes())
    if (volume.start != volume.now) rows.push_back(row);
}

template <int Dim> std::vector<std::uint64_t> CarriedFamily<Dim>::broken() const
{
  std::vector<std::uint64_t> keys;
  for (std::size_t k = 0; k < bonds_.size(); ++k)
    if (gone_[k] && !bonds_[k].cut && counted(bonds_[k])) keys.push_back(bonds_[k].key);
  return keys;
}

template <int Dim> void CarriedFamily<Dim>::set_broken(std::span<const std::uint64_t> keys)
{
  ++revision_;
  for (std::size_t k = 0; k < bonds_.size(); ++k)
    gone_[k] = bonds_[k].cut || std::ranges::binary_search(keys, bonds_[k].key);
}

template <int Dim> void CarriedFamily<Dim>::add_joints(std::vector<std::array<Index, 2>>& pairs) const
{
  constexpr double kNothing = 1e-9; // a weight
  for (std::size_t number = 0; number < bonds_.size(); ++number) {
    if (gone_[number]) continue;
    const CarriedBond<Dim>& bond = bonds_[number];
    Index first = -1;
    for (const Index point : {bond.a, bond.b, bond.force_a, bond.force_b}) {
      const auto rows = points_.rows(point);
      const auto weights = points_.tied_weights(point);
      for (std::size_t k = 0; k < rows.size(); ++k) {
        if (std::abs(weights[k]) < kNothing) continue;
        if (first < 0) first = rows[k];
        if (first != rows[k]) pairs.push_back({first, rows[k]});
      }
    }
  }
}

template <int Dim> std::int64_t CarriedFamily<Dim>::bonds() const
{
  std::int64_t count = 0;
  for (std::size_t k = 0; k < bonds_.size(); ++k) count += !gone_[k] && counted(bonds_[k]);
  return count;
}

template class CarriedFamily<2>;
template class CarriedFamily<3>;
} // namespace pdx::couple
