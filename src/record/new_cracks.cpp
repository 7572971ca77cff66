#include "pdx/record/new_cracks.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/io/curve.hpp"
#include "pdx/scene/discretisation.hpp"

#include <nlohmann/json.hpp>

namespace pdx::record {
void NewCracks::look(const scene::Discretisation& d, double load)
{
  grounds_.clear();
  for (const couple::Surroundings& around : d.around) {
    const couple::PatchShape& shape = around.shape();
    grounds_.push_back(
        {{shape.lattice, shape.active}, files_.options.pd.horizon_ratio * shape.lattice.dx, shape.names});
  }
  const couple::ParticleDamage damage = couple::particle_damage(d.system.rows, *d.bonds, d.carried);
  std::vector<track::Arrival> mine;
  for (std::size_t k = 0; k < damage.damage.size(); ++k) {
    if (damage.damage[k] < files_.options.post.tip_damage) continue;
    const pd::Particle& particle = d.particles[k];
    const couple::PatchShape& shape = d.around[static_cast<std::size_t>(particle.patch)].shape();
    const std::uint64_t name = shape.names.of(shape.active.site(particle.site));
    if (!known_.contains(name)) mine.push_back({name, load});
  }
  for (const track::Arrival& arrival : gather_all(files_.comm(), mine))
    if (known_.insert(arrival.site).second) arrivals_.push_back(arrival);
}

std::vector<track::GrownTip> NewCracks::tips() const
{
  const crack::CrackSet cracks = scene::cracks_in(files_.options, files_.scene.model->body);
  std::vector<track::CrackStart> given;
  for (const crack::Tip& tip : cracks.tips()) given.push_back({tip.at, tip.direction});
  return track::new_cracks(arrivals_, grounds_, files_.scene.model->body, given);
}

void NewCracks::add_paths(std::size_t first, io::Curve& curve) const
{
  for (const track::GrownTip& tip : tips()) {
    if (tip.path.empty()) continue;
    for (const track::PathPoint& point : tip.path) {
      const Vector<2> at = files_.options.frame.given<2>(point.at);
      curve.row(std::vector<double>{static_cast<double>(first), point.time, at[0], at[1]});
    }
    ++first;
  }
}

void NewCracks::add_results(nlohmann::ordered_json& results) const
{
  const auto place = [this](const Vector<2>& x) {
    const Vector<2> at = files_.options.frame.given<2>(x);
    return nlohmann::ordered_json{at[0], at[1]};
  };
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const track::GrownTip& tip : tips()) {
    if (tip.path.empty()) continue;
    list.push_back({{"mouth", place(tip.path.front().at)},
                    {"tip", place(tip.at)},
                    {"length", tip.length},
                    {"began", tip.path.front().time},
                    {"arrived", tip.path.back().time}});
  }
  results["new_cracks"] = std::move(list);
}
} // namespace pdx::record
