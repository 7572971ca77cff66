#include "pdx/base/events.hpp"
#include "pdx/law/fracture.hpp"
#include "pdx/post/tip_frame.hpp"

namespace pdx::post {
std::vector<TipModes> contour_modes(const pd::LatticePart<2>& part, std::size_t values, const law::Elastic& law,
                                    const crack::Tip& tip, double scale, const SideOfCrack& side, const JWith& j)
{
  static Event event("post_contour_modes");
  Timed timed(event);
  const geom::Lattice<2>& lattice = part.lattice();
  const TipFrame frame(tip);
  const double modulus = law::crack_modulus(law);
  std::vector<TipModes> modes;
  for (std::size_t k = 0; k < 3; ++k) {
    const bool force = kTipLoads[k] == law::TipLoad::force; // its strain falls like 1 / r: alike ten spacings away
    const double factor = force ? scale * std::sqrt(10.0 * lattice.dx) : scale;
    std::vector<double> added(values, 0.0);
    for (std::size_t n = 0; n < part.sites().size(); ++n) {
      const Vector<2> x = lattice.point(part.site(part.sites()[n]));
      const Vector<2> u = factor * frame.displacement(kTipLoads[k], law, x, side);
      const std::size_t at = 2 * (static_cast<std::size_t>(part.first_row()) + n);
      added[at] = u.x();
      added[at + 1] = u.y();
    }
    const std::vector<ContourJ> more = j(added);
    for (double& value : added) value = -value;
    const std::vector<ContourJ> less = j(added);
    modes.resize(more.size());
    for (std::size_t c = 0; c < more.size(); ++c) {
      const double interaction = 0.5 * (more[c].j - less[c].j) / factor;
      (k == 0   ? modes[c].opening
       : k == 1 ? modes[c].sliding
                : modes[c].along) = (force ? 1.0 : 0.5) * modulus * interaction;
    }
  }
  return modes;
}
} // namespace pdx::post
