#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/base/tensor.hpp"

#include <compare>

namespace pdx::mpm {
/// A cell, or a node, of the grid of a body, by its place there.
template <int Dim> struct GridPlace {
  Index body = 0;
  Site<Dim> at{};
  auto operator<=>(const GridPlace&) const = default;
};

/// A cell of the grid of a body, and the global rows of its corners, x fastest.
template <int Dim> struct GridCell : GridPlace<Dim> {
  std::array<PetscInt, (1U << Dim)> rows{};
};
} // namespace pdx::mpm
