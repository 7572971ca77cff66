#include "pdx/app/crack_watch.hpp"

#include "pdx/app/crack_results.hpp"
#include "pdx/app/solid.hpp"
#include "pdx/law/waves.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace pdx::app {
namespace {
geom::Lattice<2> plane_of(const geom::Lattice<3>& lattice)
{
  return {lattice.origin.head<2>(), lattice.dx, {lattice.count[0], lattice.count[1]}};
}

std::vector<track::TreeGround> grounds_of(const Standing& scene)
{
  std::vector<track::TreeGround> grounds;
  if (scene.solid) {
    const pd::LatticePart<3>& part = *scene.solid->bonds->parts()[0];
    return {{plane_of(part.lattice()), part.stencil().horizon}};
  }
  for (std::size_t p = 0; p < scene.plan->shapes.size(); ++p) {
    const couple::PatchShape& shape = scene.plan->shapes[p];
    grounds.push_back({{shape.lattice, shape.active}, scene.plan->stencils[p].horizon});
  }
  return grounds;
}

/// From the crack's direction to the way from its old tip to the new one; left is positive.
double angle_degrees(const crack::Tip& from, const Vector<2>& to)
{
  const Vector<2> way = to - from.at;
  const double across = from.direction.x() * way.y() - from.direction.y() * way.x();
  return std::atan2(across, from.direction.dot(way)) * 180.0 / std::numbers::pi;
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

CrackWatch::CrackWatch(const RunFiles& files)
    : files_(files),
      tracker_(files.comm(), files.scene.model->cracks.tips(), grounds_of(files.scene), files.options.post.tip_damage)
{
  const Model& d = *files.scene.model;
  for (int k = 0; k < d.cracks.size(); ++k) given_ += length_inside(d, k);
}

std::unique_ptr<CrackWatch> CrackWatch::make(const RunFiles& files)
{
  const Model& d = *files.scene.model;
  if (!d.breaker || files.scene.cloud) return nullptr; // tips are found on lattices
  std::unique_ptr<CrackWatch> watch(new CrackWatch(files));
  for (std::size_t t = 0; t < d.cracks.tips().size(); ++t)
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
  row.insert(row.end(), {given_ + now.grown, now.speed, static_cast<double>(now.tips)});
}

void CrackWatch::look(double time, std::int64_t bonds_broken)
{
  if (bonds_broken == broken_) return tracker_.nothing_new(time);
  broken_ = bonds_broken;
  if (files_.scene.solid) return look_at_layer(time);
  const Discretisation& d = *files_.scene.d;
  couple::ParticleDamage damage = couple::particle_damage(d.system.rows, *d.bonds, d.carried);
  for (std::size_t k = 0; k < damage.damage.size(); ++k) damage.damage[k] += damage.precrack[k];
  tracker_.look(time, d.particles, damage.damage);
}

void CrackWatch::look_at_layer(double time)
{
  const Solid& solid = *files_.scene.solid;
  const geom::Lattice<3>& lattice = solid.bonds->parts()[0]->lattice();
  const geom::Lattice<2> plane = plane_of(lattice);
  const couple::ParticleDamage all = couple::particle_damage<3>(solid.system.rows, *solid.bonds, nullptr);
  std::vector<pd::Particle> layer;
  std::vector<double> damage;
  for (std::size_t k = 0; k < solid.particles.size(); ++k) {
    const Site<3> site = lattice.site(solid.particles[k].site);
    if (site[2] != lattice.count[2] / 2) continue;
    layer.push_back(solid.particles[k]);
    layer.back().site = static_cast<Index>(plane.number({site[0], site[1]}));
    damage.push_back(all.damage[k] + all.precrack[k]);
  }
  tracker_.look(time, layer, damage);
}

std::optional<CrackNotes> CrackWatch::notes() const
{
  if (broken_ < 0) return std::nullopt;
  return CrackNotes{broken_, tracker_.state()};
}

void CrackWatch::take_notes(CrackNotes notes)
{
  broken_ = notes.bonds_broken;
  tracker_.resume(std::move(notes.tracker));
}

void CrackWatch::write_results(nlohmann::ordered_json& results) const
{
  const std::span<const crack::Tip> given = files_.scene.model->cracks.tips();
  const track::CrackTree& tree = tracker_.tree();
  const double limit = law::rayleigh_speed(files_.options.elastic);
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
  results["crack_length"] = given_ + tracker_.now().grown;
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
} // namespace pdx::app
