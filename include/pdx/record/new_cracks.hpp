#pragma once
#include "pdx/record/run_files.hpp"
#include "pdx/track/new_cracks.hpp"

#include <nlohmann/json_fwd.hpp>
#include <unordered_set>

namespace pdx::io {
class Curve;
}
namespace pdx::scene {
struct Discretisation;
}

namespace pdx::record {
/// Cracks of a static scene that begin where none was given, from load to load. Damage, and so these cracks, is known
/// by names of sites: patches may grow meanwhile, but hand nothing back. What was broken before a restart counts from
/// there.
class NewCracks {
public:
  explicit NewCracks(const RunFiles& files) : files_(files) {} ///< a scene stands
  /// Looks for particles that damage has reached since the last look. Collective.
  void look(const scene::Discretisation& d, double load);
  /// Appends "tip, load, x, y" of all paths, tips numbered from `first` on.
  void add_paths(std::size_t first, io::Curve& curve) const;
  /// A list of cracks: mouth, tip, length, and the loads at which it began and came as far as it is.
  void add_results(nlohmann::ordered_json& results) const;

private:
  std::vector<track::GrownTip> tips() const;

  const RunFiles& files_;
  std::vector<track::TreeGround> grounds_; // at the last look
  std::vector<track::Arrival> arrivals_;   // by load; all ranks alike
  std::unordered_set<std::uint64_t> known_;
};
} // namespace pdx::record
