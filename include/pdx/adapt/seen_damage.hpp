#pragma once
#include "pdx/adapt/scene_view.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace pdx::adapt {
/// The damage of particles when it was last looked at, by name: what a crack leaves behind it is no news.
class SeenDamage {
public:
  /// Owned particles that lost bonds since they were seen last, ascending. All are seen then.
  std::vector<Index> news(const SceneView& scene);
  /// Another scene stands.
  void leave_scene() { last_.clear(); }
  /// Cells may be other ranks' from now on: what one has seen, all know. Collective.
  void share(MPI_Comm comm);

  /// Of all particles that this rank has seen damaged, by the name of a site; those of others do no harm.
  const std::unordered_map<std::uint64_t, double>& entries() const { return damage_; }
  /// What was seen later is more.
  void take(std::uint64_t name, double damage)
  {
    double& seen = damage_[name];
    seen = std::max(seen, damage);
  }

private:
  std::unordered_map<std::uint64_t, double> damage_; // of what is damaged, by the name of a site
  std::unordered_set<std::uint64_t> fresh_;          // seen since it was shared
  std::vector<double> last_; // per particle of the scene that stands: the same, 0 before a name was looked up
};
} // namespace pdx::adapt
