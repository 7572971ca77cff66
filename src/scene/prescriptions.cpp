#include "pdx/scene/prescriptions.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/couple/pin_term.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
namespace {
constexpr double kAlong = 1e-9; // of a unit vector

/// The only axis that a direction has a part along; none if it is slanted.
std::optional<Index> axis_of(const Vector<3>& along)
{
  for (Index a = 0; a < 3; ++a)
    if (std::abs(along[a]) >= 1.0 - 1e-15) return a;
  return std::nullopt;
}
} // namespace

Prescriptions::Prescriptions(const options::SceneOptions& options, Model& model)
    : options_(options), model_(model), dim_(model.system.rows.dim)
{
  model.system.load.assign(static_cast<std::size_t>(model.system.rows.owned() * dim_), 0.0);
}

bool Prescriptions::is_set(Index row) const
{
  return row >= model_.system.rows.nodes && row < model_.system.rows.first_particle();
}

void Prescriptions::throw_in(const options::BoundaryCondition& c, const std::set<Index>& rows)
{
  auto& velocity = model_.system.initial_velocity;
  velocity.resize(static_cast<std::size_t>(model_.system.rows.owned() * dim_), 0.0);
  for (const Index row : rows)
    for (Index a = 0; a < dim_; ++a)
      velocity[static_cast<std::size_t>(dim_ * row + a)] = (*c.initial_velocity)[a]; // of a set that of its half
}

/// How a condition holds a component, if it does.
std::optional<Prescriptions::Held> Prescriptions::held_by(const options::BoundaryCondition& c, Index row,
                                                          Index axis) const
{
  using Kind = field::Drive::Kind;
  const auto a = static_cast<std::size_t>(axis);
  Held held{0.0, static_cast<std::size_t>(&c - options_.conditions.data()), Kind::displacement};
  if (c.roller) {
    if (axis_of(*c.roller) != axis) return std::nullopt;
    return held;
  }
  if (c.turn) {
    held.kind = Kind::turn;
    if (is_set(row) || axis > 1) return held; // a held crack does not open
    const auto first = static_cast<std::size_t>(dim_ * row);
    const Vector<2> arm = Vector<2>(model_.system.coordinates[first], model_.system.coordinates[first + 1]) - *c.centre;
    held.value = arm[axis];
    held.across = axis == 0 ? -arm[1] : arm[0];
    return held;
  }
  const bool moves = c.velocity[a].has_value();
  const std::optional<double>& value = (moves ? c.velocity : c.displacement)[a];
  if (!value) return std::nullopt;
  if (moves) held.kind = Kind::velocity;
  held.value = is_set(row) ? 0.0 : *value;
  return held;
}

void Prescriptions::hold(const options::BoundaryCondition& c, const std::set<Index>& rows)
{
  HeldPart part{c.name, {}, c.centre};
  const auto take = [&](Index component, bool contested) {
    if (contested)
      for (HeldPart& earlier : model_.held_parts) std::erase(earlier.components, component);
    part.components.push_back(component);
  };
  const bool slanted = c.rolls_slanted();
  for (const Index row : rows) {
    const bool rolled = rolled_.contains(row);
    for (Index a = 0; a < dim_; ++a) {
      const Index component = dim_ * row + a;
      const bool contested = values_.contains(component) || rolled;
      const std::optional<Held> held = held_by(c, row, a);
      if (held) values_[component] = *held;
      if (held || slanted) take(component, contested);
    }
    if (slanted) rolled_[row].push_back({*c.roller, static_cast<std::size_t>(&c - options_.conditions.data())});
  }
  model_.held_parts.push_back(std::move(part));
}

void Prescriptions::load(const options::BoundaryCondition& c, std::span<const double> force)
{
  field::Drive drive;
  drive.history = c.history.value_or(field::History());
  for (std::size_t k = 0; k < force.size(); ++k) {
    model_.system.load[k] += force[k];
    if (force[k] == 0.0) continue;
    drive.components.push_back(static_cast<Index>(k));
    drive.values.push_back(force[k]);
  }
  if (options_.time.dynamic()) model_.system.drives.push_back(std::move(drive));
}

void Prescriptions::spring(const options::BoundaryCondition& c, const std::vector<SideShare>& shares)
{
  const auto dim = static_cast<std::size_t>(dim_);
  std::map<Index, std::vector<double>> blocks;
  for (const SideShare& share : shares) {
    const Vector<3> n = c.springs->direction.value_or(share.normal);
    std::vector<double>& block = blocks.try_emplace(share.row, dim * dim, 0.0).first->second;
    for (std::size_t a = 0; a < dim; ++a)
      for (std::size_t b = 0; b < dim; ++b) {
        const double along = n[static_cast<Eigen::Index>(a)] * n[static_cast<Eigen::Index>(b)];
        block[a * dim + b] +=
            share.area * (c.springs->along * along + c.springs->across * ((a == b ? 1.0 : 0.0) - along));
      }
  }
  std::vector<Index> rows;
  std::vector<double> stiffness;
  for (const auto& [row, block] : blocks) {
    rows.push_back(row);
    stiffness.insert(stiffness.end(), block.begin(), block.end());
  }
  auto term = std::make_unique<field::SpringTerm>(dim_, std::move(rows), std::move(stiffness));
  model_.system.supports.push_back(term.get());
  model_.supports.push_back({c.name, term.get()});
  model_.system.terms.push_back(std::move(term));
}

void Prescriptions::pin(const options::BoundaryCondition& c, std::vector<double> half_sizes)
{
  couple::PinMotion motion{*c.at, {}, c.history.value_or(field::History()), {}, options_.time.dynamic()};
  for (std::size_t a = 0; a < 2; ++a) {
    motion.moves[a] = c.velocity[a].has_value();
    motion.by[static_cast<Eigen::Index>(a)] = (motion.moves[a] ? c.velocity[a] : c.displacement[a]).value_or(0.0);
  }
  const double thickness = dim_ == 2 ? options_.elastic.thickness : 0.0;
  auto term =
      std::make_unique<couple::PinTerm>(model_.system.rows, model_.system.coordinates, std::move(half_sizes),
                                        couple::PinRule{c.pin->radius, c.pin->stiffness, thickness}, std::move(motion));
  double deepest = term->deepest();
  MPI_Allreduce(MPI_IN_PLACE, &deepest, 1, MPI_DOUBLE, MPI_MAX, model_.system.rows.comm);
  if (deepest > couple::PinTerm::kTouching * c.pin->radius)
    throw UserError(fmt::format("-bc_{0}_pin begins {1:.4g} m deep in the body: move {0}_at away by that, or make it "
                                "smaller",
                                c.name, deepest));
  model_.system.supports.push_back(term.get());
  model_.supports.push_back({c.name, term.get()});
  model_.system.terms.push_back(std::move(term));
}

/// Where rollers and what is held along axes meet: what is left of each roller across the others; where nothing is left
/// free, all is held. @return the condition that something else moves along its roller, none if there is none
std::optional<std::size_t> Prescriptions::settle_rollers(Index row, const std::vector<Rolled>& all)
{
  std::vector<Vector<3>> basis;
  bool moved[3] = {false, false, false};
  for (Index a = 0; a < dim_; ++a)
    if (const auto held = values_.find(dim_ * row + a); held != values_.end()) {
      basis.push_back(Vector<3>::Unit(a));
      moved[a] = held->second.value != 0.0 || held->second.across != 0.0;
    }
  std::optional<std::size_t> clash;
  std::vector<field::Roller> left;
  for (const Rolled& rolled : all) {
    Vector<3> along = rolled.along;
    for (Index a = 0; a < dim_; ++a)
      if (moved[a] && std::abs(along[a]) > kAlong) clash = rolled.condition;
    for (const Vector<3>& known : basis) along -= along.dot(known) * known;
    if (along.norm() < kAlong) continue;
    basis.push_back(along.normalized());
    left.push_back({row, basis.back()});
  }
  if (static_cast<Index>(basis.size()) < dim_) {
    model_.system.rollers.insert(model_.system.rollers.end(), left.begin(), left.end());
    return clash;
  }
  for (Index a = 0; a < dim_; ++a) values_.try_emplace(dim_ * row + a, Held{0.0, all.back().condition});
  return clash;
}

void Prescriptions::settle_rollers()
{
  int clash = -1;
  for (const auto& [row, all] : rolled_)
    if (const auto condition = settle_rollers(row, all)) clash = std::max(clash, static_cast<int>(*condition));
  MPI_Allreduce(MPI_IN_PLACE, &clash, 1, MPI_INT, MPI_MAX, model_.system.rows.comm);
  if (clash >= 0)
    throw UserError(
        fmt::format("-bc_{}_roller holds what another condition moves: leave the places that both choose to "
                    "one of them",
                    options_.conditions[static_cast<std::size_t>(clash)].name));
}

void Prescriptions::finish()
{
  using Kind = field::Drive::Kind;
  settle_rollers();
  field::System& system = model_.system;
  std::map<std::pair<std::size_t, Kind>, field::Drive> drives; // by condition, displacements and velocities apart
  for (const auto& [component, held] : values_) {
    const options::BoundaryCondition& c = options_.conditions[held.condition];
    system.prescribed.components.push_back(component);
    system.prescribed.values.push_back(held.value);
    if (held.kind == Kind::turn) {
      system.turning.push_back({system.prescribed.values.size() - 1, *c.turn, held.value, held.across});
      system.prescribed.values.back() = (std::cos(*c.turn) - 1.0) * held.value + std::sin(*c.turn) * held.across;
    }
    field::Drive& drive = drives[{held.condition, held.kind}];
    drive.kind = held.kind;
    drive.history = c.history.value_or(field::History());
    drive.components.push_back(component);
    drive.values.push_back(held.value);
    if (held.kind != Kind::turn) continue;
    drive.turn = *c.turn;
    drive.across.push_back(held.across);
  }
  for (auto& [key, drive] : drives)
    if (options_.time.dynamic()) system.drives.push_back(std::move(drive));
}
} // namespace pdx::scene
