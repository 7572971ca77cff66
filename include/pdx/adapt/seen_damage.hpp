#pragma once
#include "pdx/adapt/scene_view.hpp"

#include <unordered_map>

namespace pdx::adapt {
/// The damage of particles when it was last looked at, by name: what a crack leaves behind it is no news.
class SeenDamage {
public:
  /// Owned particles that lost bonds since they were seen last, ascending. All are seen then.
  std::vector<Index> news(const SceneView& scene);
  /// Another scene stands.
  void leave_scene() { last_.clear(); }

  /// Of all particles that this rank has seen damaged, by the name of a site; those of others do no harm.
  const std::unordered_map<std::uint64_t, double>& entries() const { return damage_; }
  void take(std::uint64_t name, double damage) { damage_[name] = damage; }

private:
  std::unordered_map<std::uint64_t, double> damage_; // of what is damaged, by the name of a site
  std::vector<double> last_; // per particle of the scene that stands: the same, 0 before a name was looked up
};
} // namespace pdx::adapt
