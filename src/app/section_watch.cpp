#include "pdx/app/section_watch.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <tuple>

namespace pdx::app {
namespace sections {
/// A column of particles across the axis, as one rank or all see it.
struct Column {
  Index body;
  std::int64_t lattice, number; ///< of the body's lattice, along the axis
  std::int64_t particles, damaged;
  double place; ///< of the particles along the axis [m]
  double spacing;

  bool operator<(const Column& other) const
  {
    return std::tie(body, lattice, number) < std::tie(other.body, other.lattice, other.number);
  }
  bool same_body(const Column& other) const { return body == other.body && lattice == other.lattice; }
};

void sum_alike(std::vector<Column>& columns)
{
  std::ranges::sort(columns, [](const Column& a, const Column& b) { return a < b; });
  std::vector<Column> sums;
  for (const Column& column : columns)
    if (!sums.empty() && sums.back().same_body(column) && sums.back().number == column.number) {
      sums.back().particles += column.particles;
      sums.back().damaged += column.damaged;
    } else
      sums.push_back(column);
  columns = std::move(sums);
}

std::vector<Column> columns_here(const RunFiles& files, std::size_t axis)
{
  const Discretisation& d = *files.scene.d;
  const couple::ParticleDamage all = couple::particle_damage(d.system.rows, *d.bonds, d.carried);
  std::vector<Column> columns;
  for (std::size_t k = 0; k < d.particles.size(); ++k) {
    const pd::Particle& particle = d.particles[k];
    const couple::PatchShape& shape = files.scene.plan->shapes[static_cast<std::size_t>(particle.patch)];
    const std::int64_t number = shape.names.first[axis] + shape.active.site(particle.site)[axis];
    const bool damaged = all.damage[k] + all.precrack[k] >= files.options.post.tip_damage;
    columns.push_back({files.scene.mesh->body(particle.cell), shape.names.lattice, number, 1, damaged,
                       particle.x[static_cast<Eigen::Index>(axis)], shape.lattice.dx});
  }
  sum_alike(columns);
  return columns;
}
} // namespace sections

void SectionWatch::look(double time, std::int64_t bonds_broken)
{
  using sections::Column;
  if (time_ >= 0.0 || bonds_broken == broken_ || !files_.scene.d || !files_.scene.d->bonds) return;
  broken_ = bonds_broken;
  std::vector<Column> columns = gather_all(
      files_.comm(), sections::columns_here(files_, static_cast<std::size_t>(files_.options.post.section)));
  sections::sum_alike(columns);
  const auto parted = [&](const Column& column) { // right through the body
    std::int64_t most = 0;
    for (const Column& other : columns)
      if (other.same_body(column)) most = std::max(most, other.particles);
    return column.damaged == most;
  };
  double sum = 0.0; // what broke at one look in the first body is one section
  std::int64_t count = 0;
  const Column* first = nullptr;
  for (std::size_t k = 0; k + 1 < columns.size(); ++k) {
    const Column &column = columns[k], &next = columns[k + 1];
    if (!next.same_body(column) || next.number != column.number + 1 || !parted(column) || !parted(next)) continue;
    if (!first) first = &column;
    if (!first->same_body(column)) continue;
    sum += column.place + 0.5 * column.spacing;
    ++count;
  }
  if (!first) return;
  time_ = time;
  place_ = sum / static_cast<double>(count);
  body_ = first->body;
}

void SectionWatch::write_results(nlohmann::ordered_json& results) const
{
  if (time_ < 0.0) return;
  results["spall_time"] = time_;
  const auto axis = static_cast<Eigen::Index>(files_.options.post.section);
  results["spall_position"] = place_ + files_.options.frame.origin()[axis];
  const auto& bodies = files_.options.points.bodies;
  if (static_cast<std::size_t>(body_) < bodies.size())
    results["spall_body"] = bodies[static_cast<std::size_t>(body_)].name;
}

void SectionWatch::add_notes(std::map<std::string, double>& notes) const
{
  notes["section_time"] = time_;
  notes["section_place"] = place_;
  notes["section_body"] = body_;
}

void SectionWatch::take_notes(const std::map<std::string, double>& notes)
{
  const auto note = [&notes](const char* name, double none) {
    const auto found = notes.find(name);
    return found == notes.end() ? none : found->second;
  };
  time_ = note("section_time", -1.0);
  place_ = note("section_place", 0.0);
  body_ = static_cast<Index>(note("section_body", 0.0));
}
} // namespace pdx::app
