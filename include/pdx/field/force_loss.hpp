#pragma once
#include "pdx/base/tensor.hpp"

#include <vector>

namespace pdx::field {
/// Internal force that `Term::add_residual` added to an owned component and that is no longer there.
struct ForceLoss {
  Index component; ///< local: row * dim + direction
  double force;    ///< [N]
};
using ForceLosses = std::vector<ForceLoss>; ///< components may come several times
} // namespace pdx::field
