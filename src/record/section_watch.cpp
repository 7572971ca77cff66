#include "pdx/record/section_watch.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

namespace pdx::record {
namespace sections {
/// A column of particles across the axis, as one rank or all see it.
struct Column {
  Index body;
  std::int64_t lattice, number;             ///< of the body's lattice, along the axis
  std::int64_t particles, touched, damaged; ///< touched: lost a bond; damaged: lies beside a crack
  double place;                             ///< of the particles along the axis [m]
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
      sums.back().touched += column.touched;
      sums.back().damaged += column.damaged;
    } else
      sums.push_back(column);
  columns = std::move(sums);
}

std::vector<Column> columns_here(const RunFiles& files, std::size_t axis)
{
  std::vector<Column> columns;
  for (const auto& part : files.scene.model->parts)
    for (const scene::SeenParticle& particle : part->seen()) {
      const bool damaged = particle.damage + particle.precrack >= files.options.post.tip_damage;
      columns.push_back({particle.body, particle.lattice, particle.number[axis], 1, particle.damage > 1e-9, damaged,
                         particle.at[static_cast<Eigen::Index>(axis)], particle.spacing});
    }
  sum_alike(columns);
  return columns;
}
} // namespace sections

/// Of the whole body, whatever of it is particles now. Collective.
auto SectionWatch::counts(Index body, std::int64_t lattice) -> const Counts&
{
  const auto [known, fresh] = counts_.try_emplace({body, lattice});
  if (!fresh) return known->second;
  Counts mine;
  for (const auto& part : files_.scene.model->parts)
    part->count_sites(body, lattice, static_cast<std::size_t>(files_.options.post.section), mine);
  std::vector<std::array<std::int64_t, 2>> told;
  for (const auto& [column, sites] : mine) told.push_back({column, sites});
  for (const auto& [column, sites] : gather_all(files_.comm(), told)) known->second[column] += sites;
  return known->second;
}

void SectionWatch::look(double time, std::int64_t bonds_broken)
{
  using sections::Column;
  if (time_ >= 0.0 || bonds_broken == broken_) return;
  broken_ = bonds_broken;
  std::vector<Column> columns =
      gather_all(files_.comm(), sections::columns_here(files_, static_cast<std::size_t>(files_.options.post.section)));
  sections::sum_alike(columns);
  for (const Column& column : columns)
    if (column.touched) begun_.try_emplace({column.body, column.lattice, column.number}, time);
  const auto parted = [this](const Column& column) { // what is not must not be counted
    if (column.damaged != column.particles) return false;
    const Counts& whole = counts(column.body, column.lattice);
    const auto here = whole.find(column.number);
    return here == whole.end() || column.damaged >= here->second;
  };
  const auto begun = [this](const Column& column) { return begun_.at({column.body, column.lattice, column.number}); };
  std::vector<const Column*> found; // of sections that broke at one look, those that began first
  for (std::size_t k = 0; k + 1 < columns.size(); ++k) {
    const Column &column = columns[k], &next = columns[k + 1];
    if (!next.same_body(column) || next.number != column.number + 1 || !parted(column) || !parted(next)) continue;
    const double start = std::max(begun(column), begun(next));
    if (found.empty() || start < time_) {
      found.assign(1, &column);
      time_ = start;
    } else if (start == time_ && found[0]->same_body(column))
      found.push_back(&column);
  }
  if (found.empty()) return;
  place_ = 0.0;
  for (const Column* column : found)
    place_ += (column->place + 0.5 * column->spacing) / static_cast<double>(found.size());
  body_ = found[0]->body;
  through_ = time;
}

void SectionWatch::write_results(nlohmann::ordered_json& results) const
{
  if (time_ < 0.0) return;
  results["spall_time"] = time_;
  results["spall_through_time"] = through_;
  const auto axis = static_cast<Eigen::Index>(files_.options.post.section);
  Vector<2> place = Vector<2>::Zero();
  place[axis] = place_;
  results["spall_position"] = std::stod(fmt::format("{:.10g}", files_.options.frame.given<2>(place)[axis]));
  const auto& bodies = files_.options.points.bodies;
  if (static_cast<std::size_t>(body_) < bodies.size())
    results["spall_body"] = bodies[static_cast<std::size_t>(body_)].name;
}

void SectionWatch::add_notes(std::map<std::string, double>& notes) const
{
  for (const auto& [column, time] : begun_)
    notes[fmt::format("section_begun {} {} {}", column[0], column[1], column[2])] = time;
  notes["section_time"] = time_;
  notes["section_through"] = through_;
  notes["section_place"] = place_;
  notes["section_body"] = body_;
}

void SectionWatch::take_notes(const std::map<std::string, double>& notes)
{
  const auto note = [&notes](const char* name, double none) {
    const auto found = notes.find(name);
    return found == notes.end() ? none : found->second;
  };
  begun_.clear();
  for (const auto& [name, time] : notes) {
    std::istringstream words(name);
    std::string what;
    std::array<std::int64_t, 3> column{};
    if (words >> what >> column[0] >> column[1] >> column[2] && what == "section_begun") begun_[column] = time;
  }
  time_ = note("section_time", -1.0);
  through_ = note("section_through", -1.0);
  place_ = note("section_place", 0.0);
  body_ = static_cast<Index>(note("section_body", 0.0));
}
} // namespace pdx::record
