#include "pdx/adapt/seen_damage.hpp"

namespace pdx::adapt {
std::vector<bool> SeenDamage::news(const SceneView& scene)
{
  const couple::ParticleDamage all = couple::particle_damage(scene.halo.rows(), scene.bonds, scene.carried);
  std::vector<bool> news(scene.particles.size(), false);
  for (std::size_t k = 0; k < news.size(); ++k) {
    if (all.damage[k] <= kBroken) continue;
    const pd::Particle& p = scene.particles[k];
    const couple::PatchShape& shape = scene.around[static_cast<std::size_t>(p.patch)].shape();
    double& seen = damage_[shape.names.of(shape.active.site(p.site))];
    news[k] = all.damage[k] > seen + kBroken;
    seen = all.damage[k];
  }
  return news;
}
} // namespace pdx::adapt
