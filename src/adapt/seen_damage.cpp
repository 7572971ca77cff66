#include "pdx/adapt/seen_damage.hpp"

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
    double& seen = damage_[shape.names.of(shape.active.site(p.site))];
    if (damage > seen + kBroken) news.push_back(k);
    seen = damage;
  }
  return news;
}
} // namespace pdx::adapt
