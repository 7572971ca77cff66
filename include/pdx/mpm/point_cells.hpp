#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/law/elastic.hpp"

#include <array>
#include <cstdint>

namespace pdx::mpm {
/// How stress follows from the deformation gradient F, see `law/solid_law`.
enum class Law { corotational, neo_hooke };

/// What is the same for all material points of a body. Points lie on sites of the body's lattice, at the centres of
/// squares or cubes of side `spacing`; a cell of its grid has `ratio` of them in each direction.
struct BodyMaterial {
  law::Elastic elastic;
  Law law = Law::corotational;
  double spacing = 0.0; ///< dx [m]
  int ratio = 2;        ///< h / dx; ratio^Dim is at most 64
};

/// A cell of a body's grid in its reference state.
template <int Dim> struct PointCell {
  Index body = 0;
  std::array<PetscInt, 1U << Dim> rows{}; ///< global rows of its corners, x fastest
  std::uint64_t points = 0;               ///< bit k: a material point is on site k of the cell, x fastest
};
} // namespace pdx::mpm
