#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/mpm/body_material.hpp"

#include <array>
#include <cstdint>

namespace pdx::mpm {
/// A cell of a body's grid in its reference state.
template <int Dim> struct PointCell {
  Index body = 0;
  std::array<PetscInt, 1U << Dim> rows{}; ///< global rows of its corners, x fastest
  std::uint64_t points = 0;               ///< bit k: a material point is on site k of the cell, x fastest
};
} // namespace pdx::mpm
