#pragma once
#include "pdx/base/tensor.hpp"

#include <string>
#include <vector>

namespace pdx::options {
/// A place, or places along a line, at which fields are written as time or loads go on: `-probe_NAME_...`.
struct ProbeOptions {
  std::string name;
  std::vector<Vector<3>> places;   ///< as given [m]
  bool line = false;               ///< a row for each place, with its way along the line
  std::vector<std::string> fields; ///< by the names of datasets: displacement, velocity, stress, ...
  int every = 1;                   ///< steps, or loads

  /// Throws UserError. @param usual `every`, where nothing is said   With `describe` nothing is judged: for -help.
  static std::vector<ProbeOptions> read(bool solid, int usual, bool describe);
};
} // namespace pdx::options
