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
  for (const NamedSupport& support : supports) mine.supports += support.term->energy(local);
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
} // namespace pdx::scene
