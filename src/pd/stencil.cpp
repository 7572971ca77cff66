#include "pdx/pd/stencil.hpp"

#include "pdx/base/error.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace pdx::pd {
namespace {
constexpr double kMaxRatio = 20.0; // far beyond what bond words hold
constexpr double kRounding = 1e-9; // of lengths in units of dx: 3 dx lies on a horizon of 3 dx

template <int Dim> bool in_half(const Site<Dim>& step)
{
  for (int d = Dim - 1; d >= 0; --d)
    if (step[d] != 0) return step[d] > 0;
  return false;
}

/// Bonds of equal length; the exact key is |step|^2.
template <int Dim> int shell_of(const Arm<Dim>& arm)
{
  int square = 0;
  for (const Index s : arm.step) square += s * s;
  return square;
}

template <int Dim> void check(const StencilOptions& o)
{
  if (!(o.dx > 0.0)) throw UserError(fmt::format("particle spacing is {:g} m; it must be above 0", o.dx));
  if (!(o.horizon >= o.dx))
    throw UserError(fmt::format("the horizon {:g} m must be at least the particle spacing {:g} m", o.horizon, o.dx));
  if (!(o.horizon <= kMaxRatio * o.dx))
    throw UserError(
        fmt::format("horizon too wide: {:g} m is {:.4g} times the particle spacing; {:g} times are possible", o.horizon,
                    o.horizon / o.dx, kMaxRatio));
  if (Dim == 2 && o.thickness != o.elastic.thickness)
    throw UserError(fmt::format("the particles are {:g} m thick but the material is {:g} m thick; give one thickness",
                                o.thickness, o.elastic.thickness));
}

/// One member of the family with continuum constants; volume_share = 0 if the site is outside.
template <int Dim> Arm<Dim> make_arm(const Site<Dim>& step, const law::BondLaw<Dim>& bond, const StencilOptions& o)
{
  Arm<Dim> arm;
  arm.step = step;
  for (int d = 0; d < Dim; ++d) arm.xi[d] = step[d] * o.dx;
  arm.length = o.dx * std::sqrt(shell_of(arm));
  const double ratio = o.horizon / o.dx, beyond = std::sqrt(shell_of(arm)) - ratio;
  const bool conical = o.micromodulus == law::Micromodulus::conical;
  if (beyond > (conical ? kRounding : 0.5 - kRounding)) return arm;
  arm.volume_share = std::clamp(0.5 - beyond, 0.0, 1.0);
  if (conical && beyond > -kRounding) return arm;
  const double volume = Dim == 2 ? o.dx * o.dx * o.thickness : o.dx * o.dx * o.dx;
  arm.kappa = bond.constant(arm.length) * arm.volume_share * volume * volume;
  return arm;
}

template <int Dim> void collect_arms(const law::BondLaw<Dim>& bond, const StencilOptions& o, Stencil<Dim>& stencil)
{
  const int widest = static_cast<int>(std::ceil(o.horizon / o.dx + 0.5));
  Site<Dim> step;
  step.fill(-widest);
  while (step[Dim - 1] <= widest) {
    if (in_half<Dim>(step)) {
      const Arm<Dim> arm = make_arm<Dim>(step, bond, o);
      if (arm.kappa > 0.0)
        stencil.half.push_back(arm);
      else if (arm.volume_share > 0.0)
        stencil.mute.push_back(arm);
    }
    for (int d = 0; d < Dim; ++d) {
      if (++step[d] <= widest || d == Dim - 1) break;
      step[d] = -widest;
    }
  }
  for (const Arm<Dim>& arm : stencil.half)
    for (const Index s : arm.step) stencil.reach = std::max(stencil.reach, std::abs(s));
}

/// What one arm and its opposite add to (C11, C12): kappa xi n_x^4 / V and kappa xi n_x^2 n_y^2 / V, averaged over the
/// axes, which makes no difference to a full shell.                                     [Pa]
template <int Dim> Eigen::Vector2d moduli_of(const Arm<Dim>& arm, double volume)
{
  const Vector<Dim> squares = (arm.xi / arm.length).array().square();
  const double fourth = squares.squaredNorm();
  return arm.kappa * arm.length / volume * Eigen::Vector2d(fourth / Dim, (1.0 - fourth) / (Dim * (Dim - 1)));
}

struct Shell {
  Eigen::Vector2d moduli = Eigen::Vector2d::Zero(); ///< its part of (C11, C12)   [Pa]
  double stiffness = 0.0;                           ///< sum kappa xi / V        [Pa]
  double gamma = 1.0;                               ///< weight                  [-]
};

[[noreturn]] void refuse_calibration(double ratio)
{
  throw UserError(fmt::format("a horizon of {:.4g} times the particle spacing has too few bonds for positive weights "
                              "that give the elastic constants; take 3 or more, or calibration continuum",
                              ratio));
}

/// Least-norm weights with exact moduli: gamma = 1 + S^-1 A^T l with (A S^-1 A^T) l = target - A 1.
template <int Dim> void calibrate(const law::Elastic& solid, Stencil<Dim>& stencil)
{
  std::map<int, Shell> shells;
  Eigen::Vector2d missing(solid.c11(), solid.c12());
  for (const Arm<Dim>& arm : stencil.half) {
    const Eigen::Vector2d moduli = moduli_of(arm, stencil.volume());
    Shell& shell = shells[shell_of(arm)];
    shell.moduli += moduli;
    shell.stiffness += arm.kappa * arm.length / stencil.volume();
    missing -= moduli;
  }
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (const auto& [key, shell] : shells) normal += shell.moduli * shell.moduli.transpose() / shell.stiffness;
  const double ratio = stencil.horizon / stencil.dx;
  if (!(normal.determinant() > 1e-12 * normal(0, 0) * normal(1, 1))) refuse_calibration(ratio);
  const Eigen::Vector2d multiplier = normal.inverse() * missing;
  for (auto& [key, shell] : shells) {
    shell.gamma = 1.0 + shell.moduli.dot(multiplier) / shell.stiffness;
    if (!(shell.gamma > 0.0)) refuse_calibration(ratio);
  }
  for (Arm<Dim>& arm : stencil.half) arm.kappa *= shells[shell_of(arm)].gamma;
}
} // namespace

template <int Dim> double Stencil<Dim>::volume() const { return Dim == 2 ? dx * dx * thickness : dx * dx * dx; }

template <int Dim> double Stencil<Dim>::family_volume_full() const
{
  double beta = 0.0;
  for (const Arm<Dim>& arm : half) beta += arm.volume_share;
  for (const Arm<Dim>& arm : mute) beta += arm.volume_share;
  return 2.0 * beta * volume();
}

template <int Dim> Stencil<Dim> make_stencil(const StencilOptions& options)
{
  check<Dim>(options);
  law::Elastic elastic = options.elastic;
  if (Dim == 3) elastic.plane = law::Plane::strain; // whose C11 and C12 are those of the solid
  const law::BondLaw<Dim> bond(options.micromodulus, elastic, options.horizon);
  Stencil<Dim> stencil;
  stencil.dx = options.dx;
  stencil.thickness = Dim == 2 ? options.thickness : 1.0;
  stencil.horizon = options.horizon;
  stencil.density = options.elastic.density;
  collect_arms(bond, options, stencil);
  if (options.calibration == Calibration::lattice) calibrate(bond.elastic(), stencil);
  return stencil;
}

template <int Dim> void require_bond_words(const Stencil<Dim>& stencil)
{
  if (stencil.half.size() > kMaxHalfArms)
    throw UserError(fmt::format("horizon too wide: {:g} m is {:.4g} times the particle spacing, which makes {} bonds "
                                "per particle; {} are possible",
                                stencil.horizon, stencil.horizon / stencil.dx, 2 * stencil.half.size(),
                                2 * kMaxHalfArms));
}

template <int Dim> LatticeModuli lattice_moduli(const Stencil<Dim>& stencil)
{
  LatticeModuli m;
  for (const Arm<Dim>& arm : stencil.half) {
    const double k = arm.kappa * arm.length / stencil.volume();
    const double nx = arm.xi[0] / arm.length, ny = arm.xi[1] / arm.length;
    m.c11 += k * nx * nx * nx * nx;
    m.c12 += k * nx * nx * ny * ny;
  }
  m.c66 = m.c12; // central forces: the tensor is symmetric in all four indices
  return m;
}

template <int Dim> double papers_step(const Stencil<Dim>& stencil)
{
  double sum = 0.0; // c V / xi over half a family [N/m^4]
  for (const Arm<Dim>& arm : stencil.half) sum += arm.kappa / (arm.length * stencil.volume());
  return std::sqrt(stencil.density / sum);
}

template <int Dim> double lattice_toughness(const Stencil<Dim>& stencil, double critical_stretch)
{
  double energy = 0.0; // of the bonds across one site's share of the cut [J]
  for (const Arm<Dim>& arm : stencil.half)
    energy += std::abs(arm.step[1]) * 0.5 * arm.kappa * critical_stretch * critical_stretch * arm.length;
  return energy / (stencil.volume() / stencil.dx);
}

template struct Stencil<2>;
template struct Stencil<3>;
template Stencil<2> make_stencil<2>(const StencilOptions&);
template Stencil<3> make_stencil<3>(const StencilOptions&);
template void require_bond_words<2>(const Stencil<2>&);
template void require_bond_words<3>(const Stencil<3>&);
template LatticeModuli lattice_moduli<2>(const Stencil<2>&);
template LatticeModuli lattice_moduli<3>(const Stencil<3>&);
template double papers_step<2>(const Stencil<2>&);
template double papers_step<3>(const Stencil<3>&);
template double lattice_toughness<2>(const Stencil<2>&, double);
template double lattice_toughness<3>(const Stencil<3>&, double);
} // namespace pdx::pd
