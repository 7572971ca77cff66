#include "pdx/adapt/seen_damage.hpp"

#include "pdx/base/gather.hpp"

namespace pdx::adapt {
std::vector<Index> SeenDamage::news(const SceneView& scene)
{
  last_.resize(scene.particles.size(), 0.0);
  std::vector<Index> news;
  for (const auto& [k, damage] : couple::damaged_particles(scene.halo.rows(), scene.bonds, scene.carried)) {
    double& last = last_[static_cast<std::size_t>(k)];
    if (damage <= kBroken || damage == last) continue; // names are looked up where something is new
    last = damage;
    const pd::Particle& p = scene.particles[static_cast<std::size_t>(k)];
    const couple::PatchShape& shape = scene.around[static_cast<std::size_t>(p.patch)].shape();
    const std::uint64_t name = shape.names.of(shape.active.site(p.site));
    double& seen = damage_[name];
    if (damage > seen + kBroken) news.push_back(k);
    seen = damage;
    fresh_.insert(name);
  }
  return news;
}

void SeenDamage::share(MPI_Comm comm)
{
  struct Seen {
    std::uint64_t name;
    double damage;
  };
  std::vector<Seen> mine;
  for (const std::uint64_t name : fresh_) mine.push_back({name, damage_.at(name)});
  for (const auto& [name, damage] : gather_all(comm, mine)) take(name, damage);
  fresh_.clear();
}
} // namespace pdx::adapt
