#include "pdx/pd/bond_kernel.hpp"

#include "bond_sweep.hpp"
#include "pdx/base/error.hpp"

namespace pdx::pd {
namespace {
constexpr std::size_t kArmsMax = 128;

/// eta = u_j - u_i of W bonds.                                             [m]
template <int W, int Dim>
PDX_INLINE void relative_displacement(const BondView<Dim>& view, const BondLanes<Dim>& bond, Lanes<W> (&eta)[Dim])
{
  for (int d = 0; d < Dim; ++d) eta[d] = load<W>(view.u[d] + bond.j) - load<W>(view.u[d] + bond.i);
}

/// Free strain of W bonds, where sites swell.                             [-]
template <int W, int Dim> PDX_INLINE Lanes<W> free_strain(const BondView<Dim>& view, const BondLanes<Dim>& bond)
{
  return load<W>(view.swelling + bond.j) + load<W>(view.swelling + bond.i);
}

/// Deformed bonds and what is made of them without cancellation.
template <int Dim, int W> struct Deformed {
  Lanes<W> y[Dim];  ///< xi + eta                                                 [m]
  Lanes<W> squared; ///< |y|^2                                                    [m^2]
  Lanes<W> length;  ///< |y|                                                      [m]
  Lanes<W> growth;  ///< |y|^2 - |xi|^2 = 2 xi.eta + eta.eta                      [m^2]
  Lanes<W> divisor; ///< |xi| (|y| + |xi|), so that s = growth / divisor         [m^2]

  PDX_INLINE Deformed(const BondView<Dim>& view, const BondLanes<Dim>& bond)
  {
    Lanes<W> eta[Dim];
    relative_displacement<W>(view, bond, eta);
    squared = growth = Lanes<W>{};
    for (int d = 0; d < Dim; ++d) {
      y[d] = bond.xi[d] + eta[d];
      squared += y[d] * y[d];
      growth += (2.0 * bond.xi[d] + eta[d]) * eta[d];
    }
    length = square_root<W>(squared);
    divisor = bond.length * (length + bond.length);
  }
};

template <int W, int Dim> PDX_INLINE Lanes<W> along_bond(const BondLanes<Dim>& bond, const Lanes<W> (&v)[Dim])
{
  Lanes<W> sum{};
  for (int d = 0; d < Dim; ++d) sum += bond.xi[d] * v[d];
  return sum;
}

template <int Dim> struct LinearNeighbours {
  static constexpr int kRows = Dim;
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight,
                      Lanes<W> (&sum)[kRows]) const
  {
    Lanes<W> u[Dim];
    for (int d = 0; d < Dim; ++d) u[d] = load<W>(view.u[d] + bond.j);
    const double stiffness = bond.kappa / (bond.length * bond.length * bond.length);
    const Lanes<W> pull = weight(stiffness * along_bond<W>(bond, u));
    for (int d = 0; d < Dim; ++d) sum[d] -= bond.xi[d] * pull;
  }
};

template <int Dim> struct LinearDiagonal {
  static constexpr int kRows = Dim * Dim;
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>&, const BondLanes<Dim>& bond, Weight weight, Lanes<W> (&sum)[kRows]) const
  {
    const Lanes<W> stiffness = weight(Lanes<W>{} + bond.kappa / (bond.length * bond.length * bond.length));
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) sum[a * Dim + b] += stiffness * (bond.xi[a] * bond.xi[b]);
  }
};

template <int Dim, bool swells> struct LinearForce {
  static constexpr int kRows = Dim;
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight,
                      Lanes<W> (&sum)[kRows]) const
  {
    Lanes<W> eta[Dim];
    relative_displacement<W>(view, bond, eta);
    const double stiffness = bond.kappa / (bond.length * bond.length * bond.length);
    Lanes<W> along = along_bond<W>(bond, eta);
    if constexpr (swells) along -= bond.length * bond.length * free_strain<W>(view, bond);
    const Lanes<W> pull = weight(stiffness * along);
    for (int d = 0; d < Dim; ++d) sum[d] -= bond.xi[d] * pull;
  }
};

template <int Dim, bool swells> struct FiniteForce {
  static constexpr int kRows = Dim;
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight,
                      Lanes<W> (&sum)[kRows]) const
  {
    const Deformed<Dim, W> now(view, bond);
    Lanes<W> growth = now.growth;
    if constexpr (swells) growth -= now.divisor * free_strain<W>(view, bond);
    const Lanes<W> pull = weight(bond.kappa * growth / (now.divisor * now.length)); // kappa s / |y|
    for (int d = 0; d < Dim; ++d) sum[d] -= now.y[d] * pull;
  }
};

/// k = across I + along y y^T with across = kappa s/|y| and, since 1/|xi| - s/|y| = 1/|y|, along = kappa / |y|^3. With
/// a free strain e: across = kappa (s - e)/|y|, along = kappa (1 + e) / |y|^3.
template <int Dim, int W> struct FiniteStiffness {
  Lanes<W> across; ///< [N/m]
  Lanes<W> along;  ///< [N/m^3]
  template <class Weight> PDX_INLINE FiniteStiffness(const Deformed<Dim, W>& now, double kappa, Weight weight)
  {
    const Lanes<W> cubed = now.length * now.squared;
    const Lanes<W> inverse = kappa / (now.divisor * cubed); // one division for both
    across = weight(now.growth * now.squared * inverse);
    along = weight(now.divisor * inverse);
  }
  template <class Weight>
  PDX_INLINE void swell(const Deformed<Dim, W>& now, double kappa, Lanes<W> strain, Weight weight)
  {
    across -= weight(kappa * strain / now.length);
    along *= 1.0 + strain;
  }
};

template <int Dim, bool swells> struct FiniteNeighbours {
  static constexpr int kRows = Dim;
  std::array<const double*, Dim> x;
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight,
                      Lanes<W> (&sum)[kRows]) const
  {
    const Deformed<Dim, W> now(view, bond);
    FiniteStiffness<Dim, W> k(now, bond.kappa, weight);
    if constexpr (swells) k.swell(now, bond.kappa, free_strain<W>(view, bond), weight);
    Lanes<W> xj[Dim], projected{};
    for (int d = 0; d < Dim; ++d) {
      xj[d] = load<W>(x[d] + bond.j);
      projected += now.y[d] * xj[d];
    }
    const Lanes<W> pull = k.along * projected;
    for (int d = 0; d < Dim; ++d) sum[d] -= k.across * xj[d] + pull * now.y[d];
  }
};

template <int Dim, bool swells> struct FiniteDiagonal {
  static constexpr int kRows = Dim * Dim;
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight,
                      Lanes<W> (&sum)[kRows]) const
  {
    const Deformed<Dim, W> now(view, bond);
    FiniteStiffness<Dim, W> k(now, bond.kappa, weight);
    if constexpr (swells) k.swell(now, bond.kappa, free_strain<W>(view, bond), weight);
    for (int a = 0; a < Dim; ++a) {
      const Lanes<W> row = k.along * now.y[a];
      for (int b = 0; b < Dim; ++b) sum[a * Dim + b] += row * now.y[b];
      sum[a * Dim + a] += k.across;
    }
  }
};

template <int Dim, Kinematics kinematics, bool swells> struct EnergyDensity {
  static constexpr int kRows = 1;
  double volume; ///< [m^3]
  template <int W, class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight,
                      Lanes<W> (&sum)[kRows]) const
  {
    Lanes<W> stretch;
    if constexpr (kinematics == Kinematics::finite) {
      const Deformed<Dim, W> now(view, bond);
      stretch = now.growth / now.divisor;
    } else {
      Lanes<W> eta[Dim];
      relative_displacement<W>(view, bond, eta);
      stretch = along_bond<W>(bond, eta) * (1.0 / (bond.length * bond.length));
    }
    if constexpr (swells) stretch -= free_strain<W>(view, bond);
    sum[0] += weight(0.25 * bond.kappa * bond.length / volume * stretch * stretch);
  }
};

/// Calls act(std::true_type) if the sites of the view swell, else act(std::false_type).
template <int Dim, class Act> void whether_swelling(const BondView<Dim>& view, Act&& act)
{
  if (view.swelling)
    act(std::true_type{});
  else
    act(std::false_type{});
}

/// The linear bond stiffnesses K of whole runs, row by row of the upper triangle: the same for every particle.
template <int Dim> struct ArmStiffness {
  static constexpr int kEntries = Dim * (Dim + 1) / 2;
  double k[kArmsMax][kEntries]; ///< [N/m]
  explicit ArmStiffness(std::span<const HalfArm<Dim>> arms)
  {
    for (std::size_t h = 0; h < arms.size(); ++h) {
      const HalfArm<Dim>& arm = arms[h];
      const double stiffness = arm.kappa / (arm.length * arm.length * arm.length);
      for (int a = 0, e = 0; a < Dim; ++a)
        for (int b = a; b < Dim; ++b) k[h][e++] = stiffness * arm.xi[a] * arm.xi[b];
    }
  }
  /// Where entry (a, b) of the matrix is kept.
  static constexpr int entry(int a, int b)
  {
    const int row = a < b ? a : b, column = a < b ? b : a;
    return row * Dim - row * (row - 1) / 2 + column - row;
  }
};

/// Blocks x W particles of a whole run: each +-h pair is added up before it meets its stiffness.
template <int W, int Blocks, int Dim>
PDX_INLINE void subtract_whole(const BondView<Dim>& view, const ArmStiffness<Dim>& table, std::ptrdiff_t at,
                               std::ptrdiff_t count, double* rows)
{
  Lanes<W> sum[Blocks][Dim] = {};
  for (std::size_t h = 0; h < view.arms.size(); ++h) {
    const std::ptrdiff_t jump = view.arms[h].jump;
    PDX_UNROLL
    for (int q = 0; q < Blocks; ++q) {
      Lanes<W> pair[Dim];
      PDX_UNROLL
      for (int b = 0; b < Dim; ++b) {
        const double* u = view.u[b] + at + q * W;
        pair[b] = load<W>(u + jump) + load<W>(u - jump);
      }
      PDX_UNROLL
      for (int a = 0; a < Dim; ++a) {
        PDX_UNROLL
        for (int b = 0; b < Dim; ++b) sum[q][a] -= table.k[h][ArmStiffness<Dim>::entry(a, b)] * pair[b];
      }
    }
  }
  PDX_UNROLL
  for (int q = 0; q < Blocks; ++q) add_rows<W>(sum[q], count - q * W, rows + q * W * Dim);
}

template <int Dim> struct SubtractNeighbours {
  const BondView<Dim>& view;
  std::span<const Run> runs;
  const ArmStiffness<Dim>& table;
  double* y;
  template <int W> PDX_INLINE void run() const
  {
    constexpr int blocks = Dim == 2 ? 4 : 2, stride = blocks * W;
    for (const Run& run : runs) {
      if (run.kind == RunKind::partial) {
        sweep_partial<W>(view, run, LinearNeighbours<Dim>{}, y);
        continue;
      }
      double* rows = y + static_cast<std::ptrdiff_t>(run.row) * Dim;
      Index k = 0;
      for (; k + stride <= run.length; k += stride)
        subtract_whole<W, blocks>(view, table, run.at + k, stride, rows + k * Dim);
      for (; k < run.length; k += W) subtract_whole<W, 1>(view, table, run.at + k, run.length - k, rows + k * Dim);
    }
  }
};
} // namespace

template <int Dim> void subtract_neighbours(const BondView<Dim>& view, std::span<const Run> runs, double* y)
{
  PDX_ASSERT(view.arms.size() <= kArmsMax);
  run_here(SubtractNeighbours<Dim>{view, runs, ArmStiffness<Dim>(view.arms), y});
}

template <int Dim> void diagonal_blocks(const BondView<Dim>& view, std::span<const Run> runs, double* d)
{
  sweep(view, runs, LinearDiagonal<Dim>{}, d);
}

template <int Dim>
void add_force(const BondView<Dim>& view, std::span<const Run> runs, Kinematics kinematics, double* r)
{
  whether_swelling(view, [&](auto swells) {
    if (kinematics == Kinematics::finite)
      sweep(view, runs, FiniteForce<Dim, swells>{}, r);
    else
      sweep(view, runs, LinearForce<Dim, swells>{}, r);
  });
}

template <int Dim>
void subtract_neighbours_finite(const BondView<Dim>& view, std::type_identity_t<std::array<const double*, Dim>> x,
                                std::span<const Run> runs, double* y)
{
  whether_swelling(view, [&](auto swells) { sweep(view, runs, FiniteNeighbours<Dim, swells>{x}, y); });
}

template <int Dim> void diagonal_blocks_finite(const BondView<Dim>& view, std::span<const Run> runs, double* d)
{
  whether_swelling(view, [&](auto swells) { sweep(view, runs, FiniteDiagonal<Dim, swells>{}, d); });
}

template <int Dim>
void add_energy_density(const BondView<Dim>& view, std::span<const Run> runs, Kinematics kinematics, double volume,
                        double* density)
{
  whether_swelling(view, [&](auto swells) {
    if (kinematics == Kinematics::finite)
      sweep(view, runs, EnergyDensity<Dim, Kinematics::finite, swells>{volume}, density);
    else
      sweep(view, runs, EnergyDensity<Dim, Kinematics::small, swells>{volume}, density);
  });
}

template void subtract_neighbours<2>(const BondView<2>&, std::span<const Run>, double*);
template void diagonal_blocks<2>(const BondView<2>&, std::span<const Run>, double*);
template void add_force<2>(const BondView<2>&, std::span<const Run>, Kinematics, double*);
template void subtract_neighbours_finite<2>(const BondView<2>&, std::array<const double*, 2>, std::span<const Run>,
                                            double*);
template void diagonal_blocks_finite<2>(const BondView<2>&, std::span<const Run>, double*);
template void add_energy_density<2>(const BondView<2>&, std::span<const Run>, Kinematics, double, double*);
template void subtract_neighbours<3>(const BondView<3>&, std::span<const Run>, double*);
template void diagonal_blocks<3>(const BondView<3>&, std::span<const Run>, double*);
template void add_force<3>(const BondView<3>&, std::span<const Run>, Kinematics, double*);
template void subtract_neighbours_finite<3>(const BondView<3>&, std::array<const double*, 3>, std::span<const Run>,
                                            double*);
template void diagonal_blocks_finite<3>(const BondView<3>&, std::span<const Run>, double*);
template void add_energy_density<3>(const BondView<3>&, std::span<const Run>, Kinematics, double, double*);
} // namespace pdx::pd
