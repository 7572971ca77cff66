#include "pdx/post/nonlocal_j.hpp"

#include "pdx/base/events.hpp"
#include "pdx/law/bond_force.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::post {
namespace {
constexpr double kTie = 1e-6; // of a spacing: sides this near to the middle between two lines move outwards

/// Lines of a contour: line k lies between columns (rows) k - 1 and k.
struct Lines {
  Site<2> lower, upper;

  bool holds(const Site<2>& site) const
  {
    return site[0] >= lower[0] && site[0] < upper[0] && site[1] >= lower[1] && site[1] < upper[1];
  }
};

/// The lines of the lattice nearest to the sides of a square.
Lines lines_around(const geom::Lattice<2>& lattice, const Vector<2>& middle, double half)
{
  Lines lines{};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    const double centre = (middle[axis] - lattice.origin[axis]) / lattice.dx;
    lines.lower[d] = static_cast<Index>(std::ceil(centre - half - 0.5 - kTie));
    lines.upper[d] = static_cast<Index>(std::floor(centre + half + 0.5 + kTie));
  }
  return lines;
}

/// Do all particles within the margin of a contour's inside belong to the patch?
bool inside(const PatchState& state, const Lines& lines)
{
  const Index margin = state.margin;
  return lines.upper[0] > lines.lower[0] && lines.upper[1] > lines.lower[1] &&
         state.part.active().has_all(
             {{lines.lower[0] - margin, lines.lower[1] - margin}, {lines.upper[0] + margin, lines.upper[1] + margin}});
}

double largest_side(const PatchState& state, const Vector<2>& centre)
{
  const geom::Lattice<2>& lattice = state.part.lattice();
  double half = std::numeric_limits<double>::infinity();
  for (Eigen::Index d = 0; d < 2; ++d) {
    const double at = (centre[d] - lattice.origin[d]) / lattice.dx;
    const Index count = lattice.count[static_cast<std::size_t>(d)];
    half = std::min({half, at - state.margin, count - state.margin - at});
  }
  for (; half > 0.0 && !state.part.active().is_box(); half -= 1.0)
    if (inside(state, lines_around(lattice, centre, half))) break;
  return 2.0 * half * lattice.dx;
}

Lines place(const PatchState& state, const SquareContour& contour)
{
  const geom::Lattice<2>& lattice = state.part.lattice();
  Lines lines{};
  bool fits = true;
  for (std::size_t d = 0; d < 2; ++d) {
    const auto axis = static_cast<Eigen::Index>(d);
    const double centre = (contour.centre[axis] - lattice.origin[axis]) / lattice.dx;
    const double half = 0.5 * contour.side / lattice.dx;
    const double lower = std::ceil(centre - half - 0.5 - kTie), upper = std::floor(centre + half + 0.5 + kTie);
    fits &= lower >= state.margin && upper <= lattice.count[d] - state.margin && upper - lower >= 1.0;
    if (!fits) break;
    lines.lower[d] = static_cast<Index>(lower);
    lines.upper[d] = static_cast<Index>(upper);
  }
  if (fits && inside(state, lines)) return lines;
  const std::string place =
      fmt::format("the J contour of side {:g} m around {}", contour.side, state.frame.text(contour.centre));
  const double most = largest_side(state, contour.centre);
  if (most < lattice.dx) throw UserError(place + " does not fit into the patch: move its centre further inside");
  if (contour.side < most)
    throw UserError(fmt::format("{} holds no particle; choose a side from {:g} to {:g} m", place, lattice.dx, most));
  throw UserError(
      fmt::format("{} comes within {} particle spacing(s) of the patch's border; the largest side that fits "
                  "is {:g} m (-post_j_domain takes J over a ring of elements around the patch)",
                  place, state.margin, most));
}

/// What the differences of one particle need: u_j - u_i of the neighbours one and two steps away, where bonds to them
/// are intact.
struct Neighbours {
  std::array<Vector<2>, 2> eta; ///< one step, two steps [m]
  std::array<bool, 2> there{};
};

/// du along an axis [-] from the neighbours before and behind: central if both are there, else one-sided, of second
/// order if the particle two steps away is there; 0 for a particle that hangs on neither.
Vector<2> difference(const Neighbours& before, const Neighbours& behind, double dx)
{
  if (before.there[0] && behind.there[0]) return (behind.eta[0] - before.eta[0]) / (2.0 * dx);
  if (!before.there[0] && !behind.there[0]) return Vector<2>::Zero();
  const Neighbours& side = behind.there[0] ? behind : before;
  const double sign = behind.there[0] ? 1.0 : -1.0;
  if (side.there[1]) return sign * (4.0 * side.eta[0] - side.eta[1]) / (2.0 * dx);
  return sign * side.eta[0] / dx;
}

/// Derivative of u along `direction`, 2 per owned row.
std::vector<double> derivatives(const PatchState& state, const Vector<2>& direction,
                                const pd::LatticePart<2>::Window& window)
{
  const pd::LatticePart<2>& part = state.part;
  std::vector<double> result(state.u.size(), 0.0);
  for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k) {
    Neighbours near[2][2]; // axis; before, behind
    part.for_each_bond(k, [&](std::size_t h, int sign, const Site<2>&, double) {
      const Site<2>& step = part.stencil().half[h].step;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const Index length = step[axis];
        if (step[1 - axis] != 0 || length < 1 || length > 2) continue;
        Neighbours& to = near[axis][sign > 0];
        to.eta[static_cast<std::size_t>(length - 1)] = part.relative(window, k, h, sign);
        to.there[static_cast<std::size_t>(length - 1)] = true;
      }
    });
    Vector<2> along = Vector<2>::Zero();
    for (std::size_t axis = 0; axis < 2; ++axis)
      along += direction[static_cast<Eigen::Index>(axis)] * difference(near[axis][0], near[axis][1], part.stencil().dx);
    const auto at = 2 * static_cast<std::size_t>(part.first_row() + k);
    result[at] = along.x();
    result[at + 1] = along.y();
  }
  return result;
}

/// u one site along an axis further less u, 2 per owned row; not a number where no intact bond leads there.
std::vector<double> steps(const PatchState& state, std::size_t axis, const pd::LatticePart<2>::Window& window)
{
  const pd::LatticePart<2>& part = state.part;
  std::vector<double> result(state.u.size(), std::numeric_limits<double>::quiet_NaN());
  for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k)
    part.for_each_bond(k, [&](std::size_t h, int sign, const Site<2>&, double) {
      const Site<2>& step = part.stencil().half[h].step;
      if (sign * step[axis] != 1 || step[1 - axis] != 0) return;
      const Vector<2> eta = part.relative(window, k, h, sign);
      const auto at = 2 * static_cast<std::size_t>(part.first_row() + k);
      result[at] = eta.x();
      result[at + 1] = eta.y();
    });
  return result;
}

/// n.d of the contour's sides across an axis that pass between the site and the next one along it.
double passing_weight(const Lines& lines, const Site<2>& site, std::size_t axis, double along)
{
  const std::size_t other = 1 - axis;
  if (site[other] < lines.lower[other] || site[other] >= lines.upper[other]) return 0.0;
  return along * ((site[axis] == lines.upper[axis] - 1) - (site[axis] == lines.lower[axis] - 1));
}

/// n.d times the share of a particle's W that counts to the contour's sides next to it: half of each.
double side_weight(const Lines& lines, const Site<2>& site, const Vector<2>& direction)
{
  double weight = 0.0;
  for (std::size_t d = 0; d < 2; ++d) {
    const std::size_t other = 1 - d;
    if (site[other] < lines.lower[other] || site[other] >= lines.upper[other]) continue;
    const double along = direction[static_cast<Eigen::Index>(d)];
    if (site[d] == lines.upper[d] - 1 || site[d] == lines.upper[d]) weight += 0.5 * along;
    if (site[d] == lines.lower[d] - 1 || site[d] == lines.lower[d]) weight -= 0.5 * along;
  }
  return weight;
}

/// This rank's share of J on all contours.
class Sums {
public:
  Sums(const PatchState& state, const Vector<2>& direction, std::span<const Lines> contours)
      : state_(state), direction_(direction), contours_(contours), u_(state.part.window()),
        slope_(state.part.window()), steps_{state.part.window(), state.part.window()}
  {
    state.part.load(state.u, u_);
    derivatives_ = derivatives(state, direction, u_);
    state.part.load(derivatives_, slope_);
    for (std::size_t axis = 0; axis < 2; ++axis) state.part.load(steps(state, axis, u_), steps_[axis]);
  }

  std::vector<double> operator()() const
  {
    std::vector<double> sums(contours_.size(), 0.0);
    for (Index k = 0; k < static_cast<Index>(state_.part.sites().size()); ++k) add_particle(k, sums);
    return sums;
  }

private:
  void add_particle(Index k, std::vector<double>& sums) const
  {
    const pd::LatticePart<2>& part = state_.part;
    const Site<2> site = part.site(part.sites()[static_cast<std::size_t>(k)]);
    const double w = state_.density[static_cast<std::size_t>(part.first_row() + k)];
    bool close = false; // may a bond of the particle cross some contour?
    for (std::size_t c = 0; c < contours_.size(); ++c) {
      const Lines& lines = contours_[c];
      sums[c] += w * side_weight(lines, site, direction_) * part.stencil().dx;
      const int reach = part.stencil().reach;
      const Lines core{{lines.lower[0] + reach, lines.lower[1] + reach},
                       {lines.upper[0] - reach, lines.upper[1] - reach}};
      close |= lines.holds(site) && !core.holds(site);
    }
    if (close) subtract_bonds(k, site, sums);
    for (std::size_t axis = 0; axis < 2; ++axis) turn_mean_into_product(k, site, axis, sums);
  }

  /// Takes what the mean of W of a particle and the next has too much, 1/8 dF . deta of each of their bonds.
  void turn_mean_into_product(Index k, const Site<2>& site, std::size_t axis, std::vector<double>& sums) const
  {
    double excess = 0.0;
    bool known = false;
    for (std::size_t c = 0; c < contours_.size(); ++c) {
      const double weight = passing_weight(contours_[c], site, axis, direction_[static_cast<Eigen::Index>(axis)]);
      if (weight == 0.0) continue;
      if (!known) excess = excess_of_mean(k, axis);
      known = true;
      sums[c] -= weight * excess;
    }
  }

  double excess_of_mean(Index k, std::size_t axis) const ///< [J/m^2]
  {
    const pd::LatticePart<2>& part = state_.part;
    double sum = 0.0;
    part.for_each_bond(k, [&](std::size_t h, int sign, const Site<2>&, double weight) {
      const Vector<2> eta = part.relative(u_, k, h, sign), change = part.relative(steps_[axis], k, h, sign);
      if (change.allFinite())
        sum += (force(h, sign, weight, eta + change) - force(h, sign, weight, eta)).dot(change) / 8.0;
    });
    return sum / (part.stencil().dx * part.stencil().thickness);
  }

  void subtract_bonds(Index k, const Site<2>& site, std::vector<double>& sums) const
  {
    const pd::LatticePart<2>& part = state_.part;
    const auto at = 2 * static_cast<std::size_t>(part.first_row() + k);
    const Vector<2> own(derivatives_[at], derivatives_[at + 1]);
    part.for_each_bond(k, [&](std::size_t h, int sign, const Site<2>& other, double weight) {
      double power = 0.0;
      bool known = false;
      for (std::size_t c = 0; c < contours_.size(); ++c) {
        if (!contours_[c].holds(site) || contours_[c].holds(other)) continue;
        if (!known) power = bond_power(k, h, sign, weight, own);
        known = true;
        sums[c] -= power;
      }
    });
  }

  /// 1/2 f_ij . (u'_i + u'_j) / t  [J/m^2]
  double bond_power(Index k, std::size_t arm, int sign, double weight, const Vector<2>& own) const
  {
    const pd::LatticePart<2>& part = state_.part;
    const Vector<2> pull = force(arm, sign, weight, part.relative(u_, k, arm, sign));
    return 0.5 * pull.dot(2.0 * own + part.relative(slope_, k, arm, sign)) / part.stencil().thickness;
  }

  /// Force of the neighbour on a particle [N] at the relative displacement eta.
  Vector<2> force(std::size_t arm, int sign, double weight, const Vector<2>& eta) const
  {
    const pd::Arm<2>& half = state_.part.stencil().half[arm];
    const Vector<2> xi = sign * half.xi;
    const auto bond = state_.kinematics == law::Kinematics::finite ? law::finite_state<2>(xi, half.length, eta)
                                                                   : law::linear_state<2>(xi, half.length, eta);
    return weight * half.kappa * bond.stretch * bond.direction;
  }

  const PatchState& state_;
  Vector<2> direction_;
  std::span<const Lines> contours_;
  pd::LatticePart<2>::Window u_, slope_;
  std::array<pd::LatticePart<2>::Window, 2> steps_; ///< per axis
  std::vector<double> derivatives_;
};
} // namespace

std::vector<ContourJ> nonlocal_j(const PatchState& state, const Vector<2>& direction,
                                 std::span<const SquareContour> contours)
{
  static Event event("post_contour_j");
  Timed timed(event);
  std::vector<Lines> lines;
  for (const SquareContour& contour : contours) lines.push_back(place(state, contour));
  std::vector<double> sums = Sums(state, direction, lines)();
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, state.comm);
  std::vector<ContourJ> result;
  for (std::size_t c = 0; c < lines.size(); ++c) {
    const auto& [lower, upper] = lines[c];
    result.push_back({sums[c], 0.5 * (upper[0] - lower[0] + upper[1] - lower[1]) * state.part.lattice().dx});
  }
  return result;
}
} // namespace pdx::post
