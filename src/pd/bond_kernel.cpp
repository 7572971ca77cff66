#include "pdx/pd/bond_kernel.hpp"

#include "bond_sweep.hpp"
#include "pdx/base/error.hpp"

namespace pdx::pd {
namespace {
constexpr std::size_t kArmsMax = 128;

/// eta = u_j - u_i of eight bonds.                                             [m]
template <int Dim>
PDX_INLINE void relative_displacement(const BondView<Dim>& view, const BondLanes<Dim>& bond, Lanes (&eta)[Dim])
{
  for (int d = 0; d < Dim; ++d) eta[d] = load(view.u[d] + bond.j) - load(view.u[d] + bond.i);
}

/// Deformed bonds and what is made of them without cancellation.
template <int Dim> struct Deformed {
  Lanes y[Dim];  ///< xi + eta                                                 [m]
  Lanes squared; ///< |y|^2                                                    [m^2]
  Lanes length;  ///< |y|                                                      [m]
  Lanes growth;  ///< |y|^2 - |xi|^2 = 2 xi.eta + eta.eta                      [m^2]
  Lanes divisor; ///< |xi| (|y| + |xi|), so that s = growth / divisor         [m^2]

  PDX_INLINE Deformed(const BondView<Dim>& view, const BondLanes<Dim>& bond)
  {
    Lanes eta[Dim];
    relative_displacement(view, bond, eta);
    squared = growth = Lanes{};
    for (int d = 0; d < Dim; ++d) {
      y[d] = bond.xi[d] + eta[d];
      squared += y[d] * y[d];
      growth += (2.0 * bond.xi[d] + eta[d]) * eta[d];
    }
    length = square_root(squared);
    divisor = bond.length * (length + bond.length);
  }
};

template <int Dim> PDX_INLINE Lanes along_bond(const BondLanes<Dim>& bond, const Lanes (&v)[Dim])
{
  Lanes sum{};
  for (int d = 0; d < Dim; ++d) sum += bond.xi[d] * v[d];
  return sum;
}

template <int Dim> struct LinearNeighbours {
  static constexpr int kRows = Dim;
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    Lanes u[Dim];
    for (int d = 0; d < Dim; ++d) u[d] = load(view.u[d] + bond.j);
    const double stiffness = bond.kappa / (bond.length * bond.length * bond.length);
    const Lanes pull = weight(stiffness * along_bond(bond, u));
    for (int d = 0; d < Dim; ++d) sum[d] -= bond.xi[d] * pull;
  }
};

template <int Dim> struct LinearDiagonal {
  static constexpr int kRows = Dim * Dim;
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>&, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    const Lanes stiffness = weight(Lanes{} + bond.kappa / (bond.length * bond.length * bond.length));
    for (int a = 0; a < Dim; ++a)
      for (int b = 0; b < Dim; ++b) sum[a * Dim + b] += stiffness * (bond.xi[a] * bond.xi[b]);
  }
};

template <int Dim> struct LinearForce {
  static constexpr int kRows = Dim;
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    Lanes eta[Dim];
    relative_displacement(view, bond, eta);
    const double stiffness = bond.kappa / (bond.length * bond.length * bond.length);
    const Lanes pull = weight(stiffness * along_bond(bond, eta));
    for (int d = 0; d < Dim; ++d) sum[d] -= bond.xi[d] * pull;
  }
};

template <int Dim> struct FiniteForce {
  static constexpr int kRows = Dim;
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    const Deformed<Dim> now(view, bond);
    const Lanes pull = weight(bond.kappa * now.growth / (now.divisor * now.length)); // kappa s / |y|
    for (int d = 0; d < Dim; ++d) sum[d] -= now.y[d] * pull;
  }
};

/// k = across I + along y y^T with across = kappa s/|y| and, since 1/|xi| - s/|y| = 1/|y|, along = kappa / |y|^3.
template <int Dim> struct FiniteStiffness {
  Lanes across; ///< [N/m]
  Lanes along;  ///< [N/m^3]
  template <class Weight> PDX_INLINE FiniteStiffness(const Deformed<Dim>& now, double kappa, Weight weight)
  {
    const Lanes cubed = now.length * now.squared;
    const Lanes inverse = kappa / (now.divisor * cubed); // one division for both
    across = weight(now.growth * now.squared * inverse);
    along = weight(now.divisor * inverse);
  }
};

template <int Dim> struct FiniteNeighbours {
  static constexpr int kRows = Dim;
  std::array<const double*, Dim> x;
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    const Deformed<Dim> now(view, bond);
    const FiniteStiffness<Dim> k(now, bond.kappa, weight);
    Lanes xj[Dim], projected{};
    for (int d = 0; d < Dim; ++d) {
      xj[d] = load(x[d] + bond.j);
      projected += now.y[d] * xj[d];
    }
    const Lanes pull = k.along * projected;
    for (int d = 0; d < Dim; ++d) sum[d] -= k.across * xj[d] + pull * now.y[d];
  }
};

template <int Dim> struct FiniteDiagonal {
  static constexpr int kRows = Dim * Dim;
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    const Deformed<Dim> now(view, bond);
    const FiniteStiffness<Dim> k(now, bond.kappa, weight);
    for (int a = 0; a < Dim; ++a) {
      const Lanes row = k.along * now.y[a];
      for (int b = 0; b < Dim; ++b) sum[a * Dim + b] += row * now.y[b];
      sum[a * Dim + a] += k.across;
    }
  }
};

template <int Dim, Kinematics kinematics> struct EnergyDensity {
  static constexpr int kRows = 1;
  double volume; ///< [m^3]
  template <class Weight>
  PDX_INLINE void add(const BondView<Dim>& view, const BondLanes<Dim>& bond, Weight weight, Lanes (&sum)[kRows]) const
  {
    Lanes stretch;
    if constexpr (kinematics == Kinematics::finite) {
      const Deformed<Dim> now(view, bond);
      stretch = now.growth / now.divisor;
    } else {
      Lanes eta[Dim];
      relative_displacement(view, bond, eta);
      stretch = along_bond(bond, eta) * (1.0 / (bond.length * bond.length));
    }
    sum[0] += weight(0.25 * bond.kappa * bond.length / volume * stretch * stretch);
  }
};

/// The linear bond stiffnesses K of whole runs, row by row of the upper triangle: the same for every particle.
template <int Dim> struct ArmStiffness {
  static constexpr int kEntries = Dim * (Dim + 1) / 2;
  double k[kArmsMax][kEntries]; ///< [N/m]
  PDX_INLINE explicit ArmStiffness(std::span<const HalfArm<Dim>> arms)
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

/// Blocks x 8 particles of a whole run: each +-h pair is added up before it meets its stiffness.
template <int Blocks, int Dim>
PDX_INLINE void subtract_whole(const BondView<Dim>& view, const ArmStiffness<Dim>& table, std::ptrdiff_t at,
                               std::ptrdiff_t count, double* rows)
{
  Lanes sum[Blocks][Dim] = {};
  for (std::size_t h = 0; h < view.arms.size(); ++h) {
    const std::ptrdiff_t jump = view.arms[h].jump;
    PDX_UNROLL
    for (int q = 0; q < Blocks; ++q) {
      Lanes pair[Dim];
      PDX_UNROLL
      for (int b = 0; b < Dim; ++b) {
        const double* u = view.u[b] + at + q * kLanes;
        pair[b] = load(u + jump) + load(u - jump);
      }
      PDX_UNROLL
      for (int a = 0; a < Dim; ++a) PDX_UNROLL
      for (int b = 0; b < Dim; ++b) sum[q][a] -= table.k[h][ArmStiffness<Dim>::entry(a, b)] * pair[b];
    }
  }
  PDX_UNROLL
  for (int q = 0; q < Blocks; ++q) add_rows(sum[q], count - q * kLanes, rows + q * kLanes * Dim);
}

template <int Dim>
PDX_INLINE void subtract_neighbours_body(const BondView<Dim>& view, std::span<const Run> runs, double* y)
{
  constexpr int blocks = Dim == 2 ? 4 : 2;
  const ArmStiffness<Dim> table(view.arms);
  for (const Run& run : runs) {
    double* rows = y + static_cast<std::ptrdiff_t>(run.row) * Dim;
    if (run.kind == RunKind::partial) {
      sweep_partial(view, run, LinearNeighbours<Dim>{}, y);
      continue;
    }
    Index k = 0;
    for (; k + blocks * kLanes <= run.length; k += blocks * kLanes)
      subtract_whole<blocks>(view, table, run.at + k, blocks * kLanes, rows + k * Dim);
    for (; k < run.length; k += kLanes) subtract_whole<1>(view, table, run.at + k, run.length - k, rows + k * Dim);
  }
}
} // namespace

template <int Dim>
PDX_EVERY_CPU void subtract_neighbours(const BondView<Dim>& view, std::span<const Run> runs, double* y)
{
  PDX_ASSERT(view.arms.size() <= kArmsMax);
  subtract_neighbours_body(view, runs, y);
}

template <int Dim> PDX_EVERY_CPU void diagonal_blocks(const BondView<Dim>& view, std::span<const Run> runs, double* d)
{
  sweep(view, runs, LinearDiagonal<Dim>{}, d);
}

template <int Dim>
PDX_EVERY_CPU void add_force(const BondView<Dim>& view, std::span<const Run> runs, Kinematics kinematics, double* r)
{
  if (kinematics == Kinematics::finite)
    sweep(view, runs, FiniteForce<Dim>{}, r);
  else
    sweep(view, runs, LinearForce<Dim>{}, r);
}

template <int Dim>
PDX_EVERY_CPU void subtract_neighbours_finite(const BondView<Dim>& view,
                                              std::type_identity_t<std::array<const double*, Dim>> x,
                                              std::span<const Run> runs, double* y)
{
  sweep(view, runs, FiniteNeighbours<Dim>{x}, y);
}

template <int Dim>
PDX_EVERY_CPU void diagonal_blocks_finite(const BondView<Dim>& view, std::span<const Run> runs, double* d)
{
  sweep(view, runs, FiniteDiagonal<Dim>{}, d);
}

template <int Dim>
PDX_EVERY_CPU void add_energy_density(const BondView<Dim>& view, std::span<const Run> runs, Kinematics kinematics,
                                      double volume, double* density)
{
  if (kinematics == Kinematics::finite)
    sweep(view, runs, EnergyDensity<Dim, Kinematics::finite>{volume}, density);
  else
    sweep(view, runs, EnergyDensity<Dim, Kinematics::linear>{volume}, density);
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void subtract_neighbours<Dim>(const BondView<Dim>&, std::span<const Run>, double*);                         \
  template void diagonal_blocks<Dim>(const BondView<Dim>&, std::span<const Run>, double*);                             \
  template void add_force<Dim>(const BondView<Dim>&, std::span<const Run>, Kinematics, double*);                       \
  template void subtract_neighbours_finite<Dim>(                                                                       \
      const BondView<Dim>&, std::type_identity_t<std::array<const double*, Dim>>, std::span<const Run>, double*);      \
  template void diagonal_blocks_finite<Dim>(const BondView<Dim>&, std::span<const Run>, double*);                      \
  template void add_energy_density<Dim>(const BondView<Dim>&, std::span<const Run>, Kinematics, double, double*);
PDX_INSTANTIATE(2)
PDX_INSTANTIATE(3)
#undef PDX_INSTANTIATE
} // namespace pdx::pd
