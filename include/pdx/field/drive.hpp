#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/field/history.hpp"

#include <vector>

namespace pdx::field {
/// What acts on owned components as time goes: component k is `values[k]` times the history. What turns is held, by an
/// angle that is `turn` times the history: component k is at (cos - 1) values[k] + sin across[k].
struct Drive {
  enum class Kind {
    force,        ///< [N]
    displacement, ///< held [m]
    velocity,     ///< held, from where it is at time 0 [m/s]
    turn          ///< held [m]
  };
  Kind kind = Kind::force;
  History history;
  std::vector<Index> components; ///< local: row * dim + direction, each once
  std::vector<double> values;
  double turn = 0.0;            ///< [rad]
  std::vector<double> across{}; ///< of what turns [m]
};
} // namespace pdx::field
