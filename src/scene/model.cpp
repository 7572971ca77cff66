#include "pdx/scene/model.hpp"

#include "pdx/geom/clip.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::scene {
namespace {
constexpr double kOnSurface = 1e-9, kProlonged = 1e-3; // of a body: as `crack::CrackSet` has it of one box

/// Cracks end on the surface of the bodies that they are in, not on that of the box around all.
crack::CrackSet cracks_in_bodies(const options::SceneOptions& options)
{
  std::vector<geom::Box<2>> bodies; // that have a crack
  double size = 0.0;
  for (const geom::Box<2>& region : options.points.regions) {
    const bool cracked = std::ranges::any_of(options.cracks.lines, [&region](const crack::Polyline& line) {
      for (std::size_t p = 0; p + 1 < line.size(); ++p)
        if (region.contains(0.5 * (line[p] + line[p + 1]), -kOnSurface * region.size().norm())) return true;
      return false;
    });
    if (!cracked) continue;
    bodies.push_back(region);
    size = std::max(size, region.size().norm());
  }
  const auto inside = [bodies](const Vector<2>& x) {
    return std::ranges::any_of(
        bodies, [&x](const geom::Box<2>& body) { return body.contains(x, -kOnSurface * body.size().norm()); });
  };
  return {options.cracks.lines, inside, kProlonged * size};
}
} // namespace

bool Model::has_points() const
{
  return std::ranges::any_of(parts, [](const auto& part) { return part->is_of_points(); });
}

bool Model::has_others() const
{
  return !std::ranges::all_of(parts, [](const auto& part) { return part->is_of_points(); });
}

post::Energies Model::energies(std::span<const double> local) const
{
  post::Energies mine;
  for (const auto& part : parts) part->add_energies(local, mine);
  if (touching) touching->add_energies(local, mine);
  return mine;
}

double Model::kinetic_of_points(std::span<const double> velocity) const
{
  double mine = 0.0;
  for (const auto& part : parts) mine += part->own_kinetic(velocity);
  return mine;
}

std::optional<Tiles> Model::tiles() const
{
  std::optional<Tiles> all;
  for (const auto& part : parts)
    if (const std::optional<Tiles> tiles = part->tiles()) all = all.value_or(Tiles{}) += *tiles;
  return all;
}

Tiles Model::cells_of_points() const
{
  Tiles all;
  for (const auto& part : parts) all += part->cells();
  return all;
}

std::vector<field::OutputBlock> Model::blocks(const Picture& now) const
{
  std::vector<field::OutputBlock> all;
  for (const auto& part : parts) part->add_blocks(now, all);
  return all;
}

std::string Model::described() const
{
  std::string lines;
  for (const auto& part : parts) lines += part->described();
  return lines;
}

std::vector<io::Column> Model::more_columns() const
{
  std::vector<io::Column> columns;
  for (const auto& part : parts) part->add_columns(columns);
  return columns;
}

void Model::add_more(std::span<const double> local, std::span<const double> velocity, std::vector<double>& row) const
{
  for (const auto& part : parts) part->add_row(local, velocity, row);
}

crack::CrackSet cracks_in(const options::SceneOptions& options, const geom::Box<2>& body)
{
  const auto& lines = options.cracks.lines;
  const auto text = [&options](const Vector<2>& x) { return options.frame.text(x); };
  crack::CrackSet cracks = options.points.regions.empty() ? crack::CrackSet(lines, body) : cracks_in_bodies(options);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    bool inside = lines[k].size() < 2; // another error
    for (std::size_t p = 0; p + 1 < lines[k].size(); ++p)
      inside = inside || geom::clip<2>(lines[k][p], lines[k][p + 1], body);
    if (!inside)
      throw UserError(fmt::format("crack {}: from {} to {} no part of it is in the body, which is {} to {}", k + 1,
                                  text(lines[k].front()), text(lines[k].back()), text(body.lower), text(body.upper)));
  }
  return cracks;
}

void judge_no_fail(const options::SceneOptions& options, const geom::Box<2>& body)
{
  for (const geom::Box<2>& zone : options.fracture.no_fail) {
    if ((zone.lower.array() <= body.upper.array()).all() && (zone.upper.array() >= body.lower.array()).all()) continue;
    const Vector<2> lower = options.frame.given<2>(zone.lower), upper = options.frame.given<2>(zone.upper);
    throw UserError(fmt::format("-pd_no_fail: no part of {:.6g},{:.6g},{:.6g},{:.6g} is in the body, which is {} to {}",
                                lower.x(), lower.y(), upper.x(), upper.y(), options.frame.text(body.lower),
                                options.frame.text(body.upper)));
  }
}

template <int Dim> double critical_stretch(const options::SceneOptions& options, const pd::Stencil<Dim>& stencil)
{
  const options::FractureOptions& f = options.fracture;
  if (f.critical_stretch) return *f.critical_stretch;
  const law::BondLaw<Dim> bond(options.pd.micromodulus, options.elastic, stencil.horizon);
  return pd::critical_stretch<Dim>(stencil, bond, *f.toughness, f.by);
}
template double critical_stretch<2>(const options::SceneOptions&, const pd::Stencil<2>&);
template double critical_stretch<3>(const options::SceneOptions&, const pd::Stencil<3>&);

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

void Prescriptions::hold(const options::BoundaryCondition& c, const std::set<Index>& rows)
{
  HeldPart part{c.name, {}};
  const auto take_over = [&](Index component) {
    for (HeldPart& earlier : model_.held_parts) std::erase(earlier.components, component);
  };
  for (const Index row : rows)
    for (Index a = 0; a < dim_; ++a) {
      const bool moves = c.velocity[static_cast<std::size_t>(a)].has_value();
      if (const auto& value = (moves ? c.velocity : c.displacement)[static_cast<std::size_t>(a)]) {
        const Index component = dim_ * row + a;
        const bool contested = values_.contains(component);
        values_[component] = {is_set(row) ? 0.0 : *value, static_cast<std::size_t>(&c - options_.conditions.data()),
                              moves}; // a held crack does not open
        if (contested) take_over(component);
        part.components.push_back(component);
      }
    }
  model_.held_parts.push_back(std::move(part));
}

void Prescriptions::load(const options::BoundaryCondition& c, std::span<const double> force)
{
  field::Drive drive{field::Drive::Kind::force, c.history.value_or(field::History()), {}, {}};
  for (std::size_t k = 0; k < force.size(); ++k) {
    model_.system.load[k] += force[k];
    if (force[k] == 0.0) continue;
    drive.components.push_back(static_cast<Index>(k));
    drive.values.push_back(force[k]);
  }
  if (options_.time.dynamic()) model_.system.drives.push_back(std::move(drive));
}

void Prescriptions::finish()
{
  std::map<std::pair<std::size_t, bool>, field::Drive> drives; // by condition, displacements and velocities apart
  for (const auto& [component, held] : values_) {
    model_.system.prescribed.components.push_back(component);
    model_.system.prescribed.values.push_back(held.value);
    const options::BoundaryCondition& c = options_.conditions[held.condition];
    field::Drive& drive = drives[{held.condition, held.moves}];
    drive.kind = held.moves ? field::Drive::Kind::velocity : field::Drive::Kind::displacement;
    drive.history = c.history.value_or(field::History());
    drive.components.push_back(component);
    drive.values.push_back(held.value);
  }
  for (auto& [key, drive] : drives)
    if (options_.time.dynamic()) model_.system.drives.push_back(std::move(drive));
}
} // namespace pdx::scene
