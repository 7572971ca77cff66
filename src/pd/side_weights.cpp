#include "pdx/pd/side_weights.hpp"

#include "least_change.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

namespace pdx::pd {
namespace {
/// Half arms that are mirror images of each other in a line across the side.
struct Kind {
  int along, across; ///< sites that it spans; across >= 0 away from the side
  double mu;         ///< how many
  double kappa, length, nx, ny;
};

std::vector<Kind> kinds_of(const Stencil<2>& stencil)
{
  std::vector<Kind> kinds;
  for (const Arm<2>& arm : stencil.half) {
    const int along = arm.step[0], across = arm.step[1];
    if (along < 0) continue; // its mirror image is there too
    kinds.push_back({along, across, along && across ? 2.0 : 1.0, arm.kappa, arm.length / stencil.dx,
                     arm.xi[0] / arm.length, arm.xi[1] / arm.length});
  }
  return kinds;
}

/// Heights at which the bonds that the side takes away would have passed a line across it, all together, per crossing.
double missing_moment(const Kind& kind)
{
  double sum = 0.0;
  for (int j = 0; j < kind.along; ++j)
    for (double y = kind.across * (j + 0.5) / kind.along - 0.5; y > 0.0; y -= 1.0) sum += y;
  return kind.along ? sum / kind.along : 0.0;
}

/// Conditions A w = b on the factors w(row, kind) of the first `rows` rows, number row * kinds + kind.
class Conditions {
public:
  using Aim = SideWeights::Aim;
  Conditions(std::span<const Kind> kinds, int rows, double poisson)
      : kinds_(kinds), rows_(rows), poisson_(poisson), lines_(rows * static_cast<Eigen::Index>(kinds.size()))
  {}

  /// The planes between rows pass the bulk's sum of mu kappa of(kind).
  template <class Of> void pass_planes(Of&& of)
  {
    for (int plane = 1; plane < 2 * rows_; ++plane) {
      lines_.begin();
      for (std::size_t k = 0; k < kinds_.size(); ++k) {
        const double force = kinds_[k].mu * kinds_[k].kappa * of(kinds_[k]);
        lines_.right() += kinds_[k].across * force;
        for (int row = std::max(0, plane - kinds_[k].across); row < plane; ++row) count(row, k, force);
      }
      lines_.end();
    }
  }

  /// The moment of this power (0, 1, 2) of tension along the side.
  void hold_moment(int power, Aim aim)
  {
    lines_.begin();
    for (std::size_t k = 0; k < kinds_.size(); ++k) {
      const Kind& kind = kinds_[k];
      const double a = kind.across, along = kind.nx * kind.nx;
      const double share = kind.mu * kind.kappa * kind.length * along * stretch(kind);
      const double first = aim == Aim::bending ? (3.0 * a * a - 1.0) / 24.0 : missing_moment(kind);
      const double missing[] = {a / 2.0, first, (a * a * a - a) / 24.0};
      lines_.right() += share * missing[power];
      for (int row = 0; row < rows_; ++row) {
        const double weight = share * std::pow(row + 0.5 * a + 0.5, power);
        lines_.of(number(row, k)) += weight;
        lines_.right() += weight;
      }
    }
    lines_.end();
  }

  /// Stretch of a bond under tension along the side, of strain 1.
  double stretch(const Kind& kind) const { return kind.nx * kind.nx - poisson_ * kind.ny * kind.ny; }

  const FactorConditions& lines() const { return lines_; }

private:
  Eigen::Index number(int row, std::size_t kind) const
  {
    return row * static_cast<Eigen::Index>(kinds_.size()) + static_cast<Eigen::Index>(kind);
  }
  void count(int row, std::size_t kind, double value)
  {
    if (row < rows_)
      lines_.of(number(row, kind)) += value;
    else
      lines_.right() -= value; // deeper bonds have the factor 1
  }
  std::span<const Kind> kinds_;
  int rows_;
  double poisson_;
  FactorConditions lines_;
};

} // namespace

std::optional<SideWeights> SideWeights::solve(const Stencil<2>& stencil, Aim aim)
{
  const std::vector<Kind> kinds = kinds_of(stencil);
  const LatticeModuli moduli = lattice_moduli(stencil);
  const auto count = static_cast<Eigen::Index>(kinds.size());
  const int rows = stencil.reach;
  Eigen::VectorXd weight(rows * count);
  for (Eigen::Index k = 0; k < weight.size(); ++k) {
    const Kind& kind = kinds[static_cast<std::size_t>(k % count)];
    weight[k] = kind.mu * kind.kappa * kind.length;
  }
  weight /= weight.maxCoeff();
  for (const bool all_strains : {true, false}) {
    Conditions conditions(kinds, rows, moduli.c12 / moduli.c11);
    if (all_strains) {
      conditions.pass_planes([](const Kind& kind) { return kind.ny * kind.ny * kind.ny; });
      conditions.pass_planes([](const Kind& kind) { return kind.nx * kind.nx * kind.ny; });
    } else {
      conditions.pass_planes([&](const Kind& kind) { return conditions.stretch(kind) * kind.ny; });
    }
    for (const int power : {0, 1, 2}) conditions.hold_moment(power, aim);
    const auto w = next_to_one(conditions.lines(), weight);
    if (!w) continue;
    SideWeights result(rows, all_strains);
    for (Eigen::Index k = 0; k < w->size(); ++k) {
      const Kind& kind = kinds[static_cast<std::size_t>(k % count)];
      result.factors_[result.place(static_cast<int>(k / count), kind.along, kind.across)] = (*w)[k];
    }
    return result;
  }
  return std::nullopt;
}

/// Rows move across by v_i as the bar is stretched or bent, u_x = e x or e x y, u_y = v(y) - e x^2 / 2: the energy per
/// site along is the least over v.
BarStiffness bar_stiffness(const Stencil<2>& stencil, const SideWeights* weights, int rows)
{
  BarStiffness result;
  const LatticeModuli moduli = lattice_moduli(stencil);
  const double young = moduli.c11 - moduli.c12 * moduli.c12 / moduli.c11;
  for (const bool bend : {false, true}) {
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(rows, rows);
    Eigen::VectorXd load = Eigen::VectorXd::Zero(rows);
    double twice = 0.0; // the energy with v = 0
    for (const Kind& kind : kinds_of(stencil))
      for (int i = 0; i + kind.across < rows; ++i) {
        const int j = i + kind.across;
        double factor = kind.mu * kind.kappa * kind.length * stencil.dx / stencil.volume();
        if (weights)
          factor *= weights->at(i, kind.along, kind.across) * weights->at(rows - 1 - j, kind.along, kind.across);
        // s = n_x^2 e y + n_y (v_j - v_i) / xi with y at the middle of the bond: exact for a quadratic displacement
        const double s = kind.nx * kind.nx * (bend ? 0.5 * (i + j + 1 - rows) : 1.0), g = kind.ny / kind.length;
        twice += factor * s * s;
        load[i] -= factor * s * g;
        load[j] += factor * s * g;
        k(i, i) += factor * g * g;
        k(j, j) += factor * g * g;
        k(i, j) -= factor * g * g;
        k(j, i) -= factor * g * g;
      }
    k.array() += 1.0 / rows * k.trace(); // all v alike cost nothing
    if (rows > 1) twice -= load.dot(k.ldlt().solve(load));
    const double n = rows;
    (bend ? result.bending : result.tension) = twice / (young * (bend ? n * n * n / 12.0 : n));
  }
  return result;
}
} // namespace pdx::pd
