#include "pdx/record/crack_watch.hpp"

#include "pdx/law/waves.hpp"
#include "pdx/record/crack_state.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pdx::record {
namespace {
/// The part of a scene whose cracks are followed, null for none.
const scene::Part* followed(const RunFiles& files)
{
  for (const auto& part : files.scene.model->parts)
    if (!part->grounds(files.options).empty()) return part.get();
  return nullptr;
}

nlohmann::ordered_json place(const geom::Frame& frame, const Vector<2>& x)
{
  const Vector<2> given = frame.given<2>(x);
  return {given[0], given[1]};
}

nlohmann::ordered_json describe(const track::GrownTip& tip, const crack::Tip& from, const geom::Frame& frame)
{
  nlohmann::ordered_json entry;
  entry["start"] = place(frame, from.at);
  entry["at"] = place(frame, tip.at);
  entry["grown"] = tip.length;
  if (tip.path.empty()) return entry;
  entry["angle_degrees"] = angle_degrees(from, tip.at);
  entry["arrived"] = tip.path.back().time;
  if (tip.branched) {
    entry["branch_time"] = tip.branched->time;
    entry["branch_point"] = place(frame, tip.branched->at);
  }
  return entry;
}
} // namespace

CrackWatch::CrackWatch(const RunFiles& files, const scene::Part& part)
    : files_(files), part_(part), given_(scene::cracks_in(files.options, files.scene.model->body)),
      tracker_(files.comm(), given_.tips(), part.grounds(files.options), files.options.post.tip_damage)
{
  for (int k = 0; k < given_.size(); ++k) given_length_ += length_inside(given_, k, files.scene.model->body);
}

std::unique_ptr<CrackWatch> CrackWatch::make(const RunFiles& files)
{
  const scene::Part* part = files.scene.model->breaker ? followed(files) : nullptr;
  if (!part) return nullptr;
  std::unique_ptr<CrackWatch> watch(new CrackWatch(files, *part));
  for (std::size_t t = 0; t < watch->given_.tips().size(); ++t)
    if (watch->tracker_.tree().span(t) > 0.0) return watch;
  return nullptr;
}

void CrackWatch::columns(std::vector<io::Column>& columns)
{
  columns.insert(columns.end(), {{"crack_length", "m"}, {"crack_speed", "m/s"}, {"crack_tips", "-"}});
}

void CrackWatch::row(std::vector<double>& row) const
{
  const track::CrackNow& now = tracker_.now();
  row.insert(row.end(), {given_length_ + now.grown, now.speed, static_cast<double>(now.tips)});
}

void CrackWatch::look(double time, std::int64_t bonds_broken)
{
  if (bonds_broken == broken_) return tracker_.nothing_new(time);
  broken_ = bonds_broken;
  const scene::Watched now = part_.watched();
  tracker_.look(time, now.damage, now.name);
}

void CrackWatch::note_new()
{
  if (tracker_.has_new()) tracker_.note_new(part_.damage_of(tracker_.new_ones()));
}

std::optional<scene::CrackNotes> CrackWatch::notes() const
{
  if (broken_ < 0) return std::nullopt;
  return scene::CrackNotes{broken_, tracker_.state()};
}

void CrackWatch::take_notes(scene::CrackNotes notes)
{
  broken_ = notes.bonds_broken;
  tracker_.resume(std::move(notes.tracker));
}

bool CrackWatch::knows(const scene::CrackNotes& notes) const
{
  const options::PdOptions& pd = files_.options.pd;
  const double layer = pd.horizon_ratio * *std::ranges::max_element(pd.spacing); // particles held outside the body
  return std::ranges::all_of(notes.tracker.arrivals, [&](const track::Arrival& arrival) {
    const std::optional<Vector<2>> at = tracker_.tree().place(arrival.site);
    return at && files_.scene.model->body.contains(*at, layer);
  });
}

void CrackWatch::write_results(nlohmann::ordered_json& results) const
{
  const std::span<const crack::Tip> given = given_.tips();
  const track::CrackTree& tree = tracker_.tree();
  double limit = law::rayleigh_speed(files_.options.elastic);
  const law::Regions* regions = files_.options.regions.get();
  for (std::size_t k = 1; regions && k < regions->count(); ++k) // of the fastest material
    limit = std::max(limit, law::rayleigh_speed(regions->elastic(k)));
  const geom::Frame& frame = files_.options.frame;
  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  const track::GrownTip* longest = nullptr;
  const track::PathPoint* branch = nullptr;
  const std::vector<track::GrownTip> tips = tree.tips();
  for (const track::GrownTip& tip : tips) {
    results["crack_tips"].push_back(place(frame, tip.at));
    table.push_back(describe(tip, given[tip.start], frame));
    if (!tip.path.empty() && (!longest || tip.length > longest->length)) longest = &tip;
    if (tip.branched && (!branch || tip.branched->time < branch->time)) branch = &*tip.branched;
  }
  results["crack_length"] = given_length_ + tracker_.now().grown;
  if (const auto start = tree.start_time()) results["crack_start_time"] = *start;
  if (longest) results["crack_angle_degrees"] = angle_degrees(given[longest->start], longest->at);
  if (branch) {
    results["branch_time"] = branch->time;
    results["branch_point"] = place(frame, branch->at);
  }
  results["rayleigh_speed"] = limit;
  results["max_crack_speed"] = tracker_.largest_speed();
  results["max_crack_speed_ratio"] = tracker_.largest_speed() / limit;
  results["tips"] = table;
}

void CrackWatch::write_paths() const
{
  const std::vector<track::GrownTip> tips = tracker_.tree().tips();
  io::Curve curve(files_.comm(), std::filesystem::path(files_.options.output.directory) / "crack_path.csv",
                  {{"tip", "-"}, {"time", "s"}, {"x", "m"}, {"y", "m"}});
  for (std::size_t t = 0; t < tips.size(); ++t)
    for (const track::PathPoint& point : tips[t].path) {
      const Vector<2> at = files_.options.frame.given<2>(point.at);
      curve.row(std::vector<double>{static_cast<double>(t + 1), point.time, at[0], at[1]});
    }
  curve.close();
}
} // namespace pdx::record
