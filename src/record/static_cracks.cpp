#include "pdx/record/static_cracks.hpp"

#include "pdx/io/curve.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace pdx::record {
StaticCracks::StaticCracks(const RunFiles& files) : files_(files)
{
  const crack::CrackSet cracks = scene::cracks_in(files.options, files.scene.model->body); // as they were given
  now_ = crack_state(cracks, files.scene.model->body);
  if (!now_.ends.empty()) given_length_ = length_inside(cracks, now_.ends[0].given.crack, files.scene.model->body);
  marks_.resize(now_.ends.size());
  if (files.options.thermal.active() && files.grows()) new_.emplace(files);
}

void StaticCracks::add_results(nlohmann::ordered_json& results) const
{
  if (new_) new_->add_results(results);
}

void StaticCracks::add_columns(std::vector<io::Column>& columns) const
{
  columns.insert(columns.end(), {{"crack_length", "m"}, {"crack_first_intact", "m"}, {"crack_farthest_broken", "m"}});
  for (std::size_t t = 0; t < now_.ends.size(); ++t) {
    columns.push_back({fmt::format("tip{}_x", t + 1), "m"});
    columns.push_back({fmt::format("tip{}_y", t + 1), "m"});
  }
}

void StaticCracks::add_row(std::vector<double>& row) const
{
  const bool any = !now_.ends.empty();
  row.insert(row.end(), {now_.length, given_length_ + (any ? now_.ends[0].first_intact : 0.0),
                         given_length_ + (any ? now_.ends[0].farthest_broken : 0.0)});
  for (const CrackEnd& end : now_.ends) {
    const Vector<2> at = files_.options.frame.given<2>(end.tip());
    row.insert(row.end(), {at[0], at[1]});
  }
}

void StaticCracks::add_mode_columns(std::vector<io::Column>& columns) const
{
  for (std::size_t t = 0; t < now_.ends.size(); ++t)
    columns.insert(columns.end(), {{fmt::format("tip{}_k1", t + 1), "Pa m^0.5"},
                                   {fmt::format("tip{}_k2", t + 1), "Pa m^0.5"},
                                   {fmt::format("tip{}_t_stress", t + 1), "Pa"}});
}

void StaticCracks::add_modes(std::span<const std::optional<post::TipModes>> modes, std::vector<double>& row)
{
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  for (const auto& of_tip : modes)
    if (of_tip)
      row.insert(row.end(), {of_tip->opening, of_tip->sliding, of_tip->along});
    else
      row.insert(row.end(), {none, none, none});
}

void StaticCracks::look(const scene::Discretisation& d, double load)
{
  const std::int64_t broken = d.fracture ? d.fracture->broken() : 0;
  if (std::exchange(broken_, broken) == broken) return;
  if (new_) new_->look(d, load);
  now_ = crack_state(d, now_);
  for (std::size_t k = 0; k < now_.ends.size(); ++k) {
    std::vector<Mark>& marks = marks_[k];
    if (now_.ends[k].grown > (marks.empty() ? 0.0 : marks.back().grown)) marks.push_back({k, load, now_.ends[k].grown});
  }
}

std::vector<StaticCracks::Mark> StaticCracks::marks() const
{
  std::vector<Mark> all;
  for (const std::vector<Mark>& marks : marks_) all.insert(all.end(), marks.begin(), marks.end());
  return all;
}

bool StaticCracks::take_marks(std::span<const Mark> marks)
{
  for (const Mark& mark : marks) {
    if (mark.end >= marks_.size()) return false;
    std::vector<Mark>& of_end = marks_[mark.end];
    const Mark before = of_end.empty() ? Mark{} : of_end.back();
    if (!(mark.load > before.load && mark.grown > before.grown)) return false;
    of_end.push_back(mark);
    now_.ends[mark.end].grown = mark.grown;
  }
  return true;
}

/// The load at which a tip had come as far.
double StaticCracks::load_at(std::size_t end, double distance) const
{
  const std::vector<Mark>& marks = marks_[end];
  const auto found =
      std::ranges::find_if(marks, [distance](const Mark& mark) { return mark.grown >= distance * (1.0 - 1e-9); });
  return found == marks.end() ? marks.back().load : found->load;
}

void StaticCracks::write_paths() const
{
  if (!files_.grows()) return;
  io::Curve curve(files_.comm(), std::filesystem::path(files_.options.output.directory) / "crack_path.csv",
                  {{"tip", "-"}, {"load", "-"}, {"x", "m"}, {"y", "m"}});
  for (std::size_t k = 0; k < now_.ends.size(); ++k) {
    const crack::Polyline& path = now_.ends[k].path;
    if (path.size() < 2) continue;
    double distance = 0.0;
    for (std::size_t p = 0; p < path.size(); ++p) {
      if (p > 0) distance += (path[p] - path[p - 1]).norm();
      const Vector<2> at = files_.options.frame.given<2>(path[p]);
      curve.row(std::vector<double>{static_cast<double>(k + 1), load_at(k, distance), at[0], at[1]});
    }
  }
  if (new_) new_->add_paths(now_.ends.size() + 1, curve);
  curve.close();
}
} // namespace pdx::record
