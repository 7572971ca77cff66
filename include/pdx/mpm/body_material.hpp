#pragma once
#include "pdx/law/elastic.hpp"

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

  double side() const { return ratio * spacing; } ///< h [m]
};

/// Volume that a material point stands for: dx^2 thickness in the plane, dx^3 in space. [m^3]
template <int Dim> double point_volume(const BodyMaterial& body)
{
  return body.spacing * body.spacing * (Dim == 2 ? body.elastic.thickness : body.spacing);
}
} // namespace pdx::mpm
