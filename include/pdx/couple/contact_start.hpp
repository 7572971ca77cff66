#pragma once
#include "pdx/couple/contact_law.hpp"
#include "pdx/couple/contact_skin.hpp"

namespace pdx::couple {
/// What is taken off d0 between a point and a body's skin.
struct StartOffset {
  Index point = 0, body = 0;
  double less = 0.0; ///< [m]
};

/// Bodies that begin in touch push nothing: a point that lies in the notch of another body's stair, nearer than d0 to
/// its skin though not to its points, keeps the distance it begins with. Ascending by point, then body.
/// Throws UserError if points of two bodies are nearer than d0: they overlap.
template <int Dim> std::vector<StartOffset> start_offsets(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law);
} // namespace pdx::couple
