#pragma once
#include "pdx/base/tensor.hpp"

namespace pdx::field {
/// A row without inertia of its own. The enriched set a of node i opens the crack: the far half of the node's support
/// moves with w = u_i + factor a, and it is w that has a mass. In (u, w) the lumped mass is diagonal, and either half
/// of a body that is cut through has exactly its kinetic energy and momentum, wherever the crack runs.
struct Tie {
  Index row;     ///< of the node, owned
  Index set;     ///< of its enriched set, owned
  double factor; ///< of the set in w: the shifted step on the far side, +-2 [-]
};
} // namespace pdx::field
