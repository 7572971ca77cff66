#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/field/history.hpp"

#include <vector>

namespace pdx::field {
/// What acts on owned components as time goes: component k is `values[k]` times the history.
struct Drive {
  enum class Kind {
    force,        ///< [N]
    displacement, ///< held [m]
    velocity      ///< held, from where it is at time 0 [m/s]
  };
  Kind kind = Kind::force;
  History history;
  std::vector<Index> components; ///< local: row * dim + direction, each once
  std::vector<double> values;
};
} // namespace pdx::field
