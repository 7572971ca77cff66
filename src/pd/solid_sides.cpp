#include "pdx/pd/solid_sides.hpp"

#include "least_change.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

namespace pdx::pd {
namespace solid_sides {
using Aim = SolidSides::Aim;

/// Half arms alike by the symmetry of a square lattice, z across the side.
struct Kind {
  std::array<int, 2> along; ///< sites that it spans, the longer first
  int across;
  double mu, kappa, length; ///< how many; of each
  std::array<double, 3> squares;
};

/// Products of directions whose sums over bonds say how stiff a layer is: of x x, x y, x z and z z.
enum Product { xxxx, xxyy, xxzz, zzzz };

std::vector<Kind> kinds_of(const Stencil<3>& stencil)
{
  std::map<std::array<int, 3>, Kind> kinds;
  for (const Arm<3>& arm : stencil.half) {
    const std::array<int, 2> along{std::max(std::abs(arm.step[0]), std::abs(arm.step[1])),
                                   std::min(std::abs(arm.step[0]), std::abs(arm.step[1]))};
    const double length = arm.length / stencil.dx, square = length * length;
    Kind& kind = kinds[{along[0], along[1], arm.step[2]}];
    kind.mu += 1.0; // of a new one 0 before
    kind = {along,   arm.step[2],
            kind.mu, arm.kappa,
            length,  {along[0] * along[0] / square, along[1] * along[1] / square, arm.step[2] * arm.step[2] / square}};
  }
  std::vector<Kind> list;
  for (const auto& [key, kind] : kinds) list.push_back(kind);
  return list;
}

/// Heights at which the bonds that the side takes away would have passed a plane across it, all together, per crossing.
double missing_moment(int along, int across)
{
  double sum = 0.0;
  for (int j = 0; j < along; ++j)
    for (double y = across * (j + 0.5) / along - 0.5; y > 0.0; y -= 1.0) sum += y;
  return along ? sum / along : 0.0;
}

/// What is asked of factors beside one side (`layers` = 0) or of both of so many layers.
class Layers {
public:
  Layers(const Stencil<3>& stencil, int layers) : kinds_(kinds_of(stencil)), reach_(stencil.reach), layers_(layers)
  {
    const LatticeModuli moduli = lattice_moduli(stencil);
    poisson_ = moduli.c12 / moduli.c11;
    for (std::size_t k = 0; k < kinds_.size(); ++k)
      for (int row = 0; row < rows_of(kinds_[k]); ++row) {
        if (number(k, row) == size_) numbers_[{k, row}] = size_++;
      }
  }

  const std::vector<Kind>& kinds() const { return kinds_; }
  /// Of the bond of a kind from a layer on: its factor's number, -1 where that is 1, `size_` for a new one.
  int number(std::size_t kind, int row) const
  {
    const int nearest = layers_ ? std::min(row, layers_ - 1 - kinds_[kind].across - row) : row;
    if (nearest >= reach_) return -1;
    const auto known = numbers_.find({kind, nearest});
    return known == numbers_.end() ? size_ : known->second;
  }

  enum What { at_rest, energies, second_moments };
  /// Nothing where that cannot be had.
  std::optional<Eigen::VectorXd> solve(What most, Aim aim) const
  {
    FactorConditions conditions(size_);
    rest(conditions);
    hold(conditions, aim, 0, xxxx);
    hold(conditions, aim, 0, xxyy);
    if (most >= energies) hold(conditions, aim, 0, xxzz);
    for (const int power : {1, 2})
      for (const Product product : {xxxx, xxyy})
        if (most == second_moments && (power == 2 || !layers_)) hold(conditions, aim, power, product);
    Eigen::VectorXd weight = Eigen::VectorXd::Zero(size_);
    for (std::size_t k = 0; k < kinds_.size(); ++k)
      for (int row = 0; row < rows_of(kinds_[k]); ++row)
        if (const int factor = number(k, row); factor >= 0)
          weight[factor] += kinds_[k].mu * kinds_[k].kappa * kinds_[k].length;
    return next_to_one(conditions, weight / weight.maxCoeff());
  }

private:
  /// Layers in which bonds of a kind begin that may have a factor.
  int rows_of(const Kind& kind) const { return layers_ ? std::max(0, layers_ - kind.across) : reach_; }

  static double product(const Kind& kind, Product of)
  {
    const auto& [x, y, z] = kind.squares;
    switch (of) {
    case xxxx:
      return 0.5 * (x * x + y * y);
    case xxyy:
      return x * y;
    case xxzz:
      return 0.5 * (x + y) * z;
    default:
      return z * z;
    }
  }

  void count(FactorConditions& conditions, std::size_t kind, int row, double value) const
  {
    const int factor = number(kind, row);
    if (factor >= 0)
      conditions.of(factor) += value;
    else
      conditions.right() -= value;
  }

  /// 1. No plane between layers is passed by a force across it.
  void rest(FactorConditions& conditions) const
  {
    for (int plane = 1; plane < (layers_ ? layers_ : 2 * reach_); ++plane) {
      conditions.begin();
      for (std::size_t k = 0; k < kinds_.size(); ++k) {
        const Kind& kind = kinds_[k];
        if (kind.across == 0) continue;
        const double force =
            kind.mu * kind.kappa * (product(kind, xxzz) - poisson_ * product(kind, zzzz)) / std::sqrt(kind.squares[2]);
        const int last = layers_ ? std::min(plane, layers_ - kind.across) : plane;
        for (int row = std::max(0, plane - kind.across); row < last; ++row) count(conditions, k, row, force);
        if (!layers_) conditions.right() += kind.across * force; // what the bulk has is 0 but for rounding
      }
      conditions.end();
    }
  }

  /// 2. and 3.: the moment of a product's sum; of x x x x, and but for shear of x x y y, with what is free to contract.
  void hold(FactorConditions& conditions, Aim aim, int power, Product of) const
  {
    conditions.begin();
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const Kind& kind = kinds_[k];
      const double share = kind.mu * kind.kappa * kind.length, a = kind.across;
      const double freed = of == xxxx || power ? poisson_ : 0.0;
      const double each = share * (product(kind, of) - freed * product(kind, xxzz));
      for (int row = 0; row < rows_of(kind); ++row)
        count(conditions, k, row, each * std::pow(row + 0.5 * a + 0.5 - 0.5 * layers_, power));
      if (layers_) {
        conditions.right() += each * (power ? std::pow(layers_, 3) / 12.0 : layers_);
        continue;
      }
      for (int row = 0; row < reach_; ++row) conditions.right() += each * std::pow(row + 0.5 * a + 0.5, power);
      const double missing[] = {0.5 * a * each, share * first_moment(kind, of, aim), each * (a * a * a - a) / 24.0};
      conditions.right() += missing[power];
    }
    conditions.end();
  }

  /// Of the bonds that the side takes away. A plane across the side is passed at other heights along x than along y.
  double first_moment(const Kind& kind, Product of, Aim aim) const
  {
    double moment = 0.0;
    for (const std::size_t d : {0U, 1U}) {
      const double x = kind.squares[d], y = kind.squares[1 - d], z = kind.squares[2], a = kind.across;
      const double along = x * ((of == xxxx ? x : y) - poisson_ * z);
      moment +=
          0.5 * along * (aim == Aim::bending ? (3.0 * a * a - 1.0) / 24.0 : missing_moment(kind.along[d], kind.across));
    }
    return moment;
  }

  std::vector<Kind> kinds_;
  int reach_, layers_, size_ = 0;
  double poisson_ = 0.0;
  std::map<std::pair<std::size_t, int>, int> numbers_;
};
} // namespace solid_sides

std::optional<SolidSides> SolidSides::solve(const Stencil<3>& stencil, Aim aim)
{
  using solid_sides::Layers;
  if (stencil.half.empty()) return std::nullopt;
  SolidSides sides(stencil.reach);
  const auto table = [&](const Layers& of, const Eigen::VectorXd& w) {
    std::vector<double> factors(sides.place(stencil.reach, {0, 0, 0}, 2), 1.0);
    for (std::size_t k = 0; k < of.kinds().size(); ++k)
      for (int row = 0; row < stencil.reach; ++row) {
        const auto& [along, across, mu, kappa, length, squares] = of.kinds()[k];
        const int factor = of.number(k, row);
        if (factor < 0 || factor >= w.size()) continue;
        factors[sides.place(row, {along[0], along[1], across}, 2)] = w[factor];
        factors[sides.place(row, {along[1], along[0], across}, 2)] = w[factor];
      }
    return factors;
  };
  const Layers one(stencil, 0);
  const auto w = one.solve(Layers::second_moments, aim);
  if (!w) return std::nullopt;
  sides.half_ = table(one, *w);
  for (int layers = 1; layers < sides.thick(); ++layers) {
    const Layers both(stencil, layers);
    std::optional<Eigen::VectorXd> found;
    for (const auto most : {Layers::second_moments, Layers::energies, Layers::at_rest})
      if (!found) found = both.solve(most, aim);
    if (found) sides.thin_[static_cast<std::size_t>(layers)] = table(both, *found);
  }
  return sides;
}

/// All layers contract alike: the energy per site along is the least over both contractions.
double bar_tension(const Stencil<3>& stencil, const SolidSides* sides, const std::array<int, 2>& layers)
{
  Tensor<3> energy = Tensor<3>::Zero(); // of strains along the axes, their products
  for (const Arm<3>& arm : stencil.half) {
    double bonds = 1.0; // of this arm, in units of a site along
    for (const std::size_t axis : {1U, 2U}) {
      const int count = layers[axis - 1], span = std::abs(arm.step[axis]);
      double weights = 0.0;
      for (int below = 0; below + span < count; ++below) {
        const int above = count - 1 - below - span;
        const std::optional<double> both =
            sides ? sides->between(count, std::min(below, above), arm.step, axis) : std::optional(1.0);
        weights += both ? *both : sides->at(below, arm.step, axis) * sides->at(above, arm.step, axis);
      }
      bonds *= weights;
    }
    const Vector<3> squares = (arm.xi / arm.length).cwiseAbs2();
    energy += bonds * arm.kappa * arm.length * squares * squares.transpose();
  }
  const LatticeModuli solid = lattice_moduli(stencil);
  const double young = solid.c11 - 2.0 * solid.c12 * solid.c12 / (solid.c11 + solid.c12);
  const Eigen::Vector2d across = energy.block<2, 1>(1, 0);
  const Eigen::Vector2d contraction = energy.block<2, 2>(1, 1).inverse() * across;
  return (energy(0, 0) - across.dot(contraction)) / (young * stencil.volume() * layers[0] * layers[1]);
}
} // namespace pdx::pd
