#pragma once
#include "pdx/record/run_files.hpp"

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace pdx::record {
/// Looks for the first section across a body that is broken: a spall, with `-post_section x|y`. A section lies between
/// two columns of sites of a body, and is broken where all of both that are particles, or could become so, lie beside a
/// crack (`-post_tip_damage`).
class SectionWatch {
public:
  explicit SectionWatch(const RunFiles& files) : files_(files) {}

  /// Looks if more bonds are broken than at the last look. Collective.
  void look(double time, std::int64_t bonds_broken);
  /// Of the first that was found: `spall_time`, when its first bonds broke, `spall_through_time`, when it was broken
  /// right through, `spall_position` and `spall_body`.
  void write_results(nlohmann::ordered_json& results) const;
  /// What a restarted run needs, by name, and the way back.
  void add_notes(std::map<std::string, double>& notes) const;
  void take_notes(const std::map<std::string, double>& notes);

private:
  using Counts = std::map<std::int64_t, std::int64_t>; // of sites that may be particles, by column
  const Counts& counts(Index body, std::int64_t lattice);

  const RunFiles& files_;
  std::map<std::pair<Index, std::int64_t>, Counts> counts_; // by body and lattice
  std::int64_t broken_ = 0;
  std::map<std::array<std::int64_t, 3>, double> begun_; // body, lattice, column: when it lost its first bond [s]
  double time_ = -1.0, through_ = -1.0;                 // none yet [s]
  double place_ = 0.0;                                  // along the axis, from the body's corner [m]
  Index body_ = 0;
};
} // namespace pdx::record
