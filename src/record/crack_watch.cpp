#include "pdx/record/crack_watch.hpp"

#include "pdx/law/waves.hpp"
#include "pdx/record/crack_state.hpp"
#include "pdx/scene/layout.hpp"
#include "pdx/scene/solid.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pdx::record {
namespace {
geom::Lattice<2> plane_of(const geom::Lattice<3>& lattice)
{
  return {lattice.origin.head<2>(), lattice.dx, {lattice.count[0], lattice.count[1]}};
}

/// The middle layer, whose sites have the names of the solid.
track::TreeGround middle_of(const pd::LatticePart<3>& part)
{
  const geom::Lattice<3>& lattice = part.lattice();
  const geom::Lattice<2> plane = plane_of(lattice);
  const std::int64_t before = std::int64_t{lattice.count[2] / 2} * lattice.count[1]; // rows of other layers
  return {plane, part.stencil().horizon, {{0, before}, lattice.count[0], 0, 1}};
}

/// What is active on either of two pieces of one lattice, as the first counts its sites.
geom::SiteSet<2> united(const track::TreeGround& ground, const couple::PatchShape& shape)
{
  std::vector<geom::SiteSet<2>::Corners> boxes;
  const auto add = [&boxes](const geom::SiteSet<2>& set, const Site<2>& shift) {
    for (const geom::SiteRun<2>& run : set.runs()) {
      const Site<2> first{run.first[0] + shift[0], run.first[1] + shift[1]};
      boxes.push_back({first, {first[0] + run.length, first[1] + 1}});
    }
  };
  const auto away = [&](std::size_t d) { return static_cast<Index>(shape.names.first[d] - ground.names.first[d]); };
  add(ground.where.active, {0, 0});
  add(shape.active, {away(0), away(1)});
  return geom::SiteSet<2>(boxes);
}

/// The lattices that particles of a scene lie on, each once.
std::vector<track::TreeGround> grounds_of(const options::SceneOptions& options)
{
  std::vector<track::TreeGround> grounds;
  for (const couple::PatchShape& shape : scene::patch_shapes(options)) {
    const auto known = std::ranges::find_if(
        grounds, [&](const track::TreeGround& ground) { return ground.names.lattice == shape.names.lattice; });
    if (known == grounds.end())
      grounds.push_back({{shape.lattice, shape.active}, options.pd.horizon_ratio * shape.lattice.dx, shape.names});
    else
      known->where.active = united(*known, shape);
  }
  return grounds;
}

std::vector<track::TreeGround> grounds_of(const RunFiles& files)
{
  if (files.scene.solid) return {middle_of(*files.scene.solid->bonds->parts()[0])};
  return grounds_of(scene::Layout::given(files.options).in(files.options));
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
    : files_(files), given_(scene::cracks_in(files.options, files.scene.model->body)),
      tracker_(files.comm(), given_.tips(), grounds_of(files), files.options.post.tip_damage)
{
  for (int k = 0; k < given_.size(); ++k) given_length_ += length_inside(given_, k, files.scene.model->body);
}

std::unique_ptr<CrackWatch> CrackWatch::make(const RunFiles& files)
{
  if (!files.scene.model->breaker || files.scene.cloud) return nullptr; // tips are found on lattices
  std::unique_ptr<CrackWatch> watch(new CrackWatch(files));
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
  if (files_.scene.solid) return look_at_layer(time);
  const scene::Discretisation& d = *files_.scene.d;
  couple::ParticleDamage damage = couple::particle_damage(d.system.rows, *d.bonds, d.carried);
  for (std::size_t k = 0; k < damage.damage.size(); ++k) damage.damage[k] += damage.precrack[k];
  tracker_.look(time, damage.damage, [&](std::size_t k) {
    const pd::Particle& particle = d.particles[k];
    const couple::PatchShape& shape = files_.scene.plan->shapes[static_cast<std::size_t>(particle.patch)];
    return shape.names.of(shape.active.site(particle.site));
  });
}

void CrackWatch::look_at_layer(double time)
{
  const scene::Solid& solid = *files_.scene.solid;
  const geom::Lattice<3>& lattice = solid.bonds->parts()[0]->lattice();
  const couple::ParticleDamage all = couple::particle_damage<3>(solid.system.rows, *solid.bonds, nullptr);
  std::vector<std::uint64_t> layer;
  std::vector<double> damage;
  for (std::size_t k = 0; k < solid.particles.size(); ++k) {
    const Site<3> site = lattice.site(solid.particles[k].site);
    if (site[2] != lattice.count[2] / 2) continue;
    layer.push_back(static_cast<std::uint64_t>(solid.particles[k].site));
    damage.push_back(all.damage[k] + all.precrack[k]);
  }
  tracker_.look(time, damage, [&](std::size_t k) { return layer[k]; });
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
