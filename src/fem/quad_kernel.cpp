#include "lane_pair.hpp"
#include "pdx/fem/sweep_kernel.hpp"

#include <algorithm>
#include <utility>

/// In a bilinear cell d/d xi depends on eta alone and d/d eta on xi alone, of the place and of the displacement.
namespace pdx::fem {
namespace quads {
constexpr std::ptrdiff_t kSides = 8; // numbers of a cell in QuadBlocks::sides

/// Stiffness times a quarter of the thickness: a Gauss point has the volume of that times 4 det J.
struct Constants {
  double c11, c12, mu; // [N/m]
  explicit Constants(const law::Elastic& law)
      : c11(0.25 * law.thickness * law.c11()), c12(0.25 * law.thickness * law.c12()),
        mu(0.25 * law.thickness * law.mu())
  {}
};

/// Four numbers' inverses by one division.
template <class T> PDX_INLINE void invert(const T (&x)[2][2], T (&inverse)[2][2])
{
  const T first = x[0][0] * x[0][1], second = x[1][0] * x[1][1], all = 1.0 / (first * second);
  const T of_first = all * second, of_second = all * first;
  inverse[0][0] = of_first * x[0][1];
  inverse[0][1] = of_first * x[0][0];
  inverse[1][0] = of_second * x[1][1];
  inverse[1][1] = of_second * x[1][0];
}

/// Forces on the corners of W elements, or else their energies.
template <int W, bool finite, bool forces>
PDX_INLINE Lanes<W> element(const Constants& m, const double* sides, const Pair<Lanes<W>> (&u)[4],
                            Pair<Lanes<W>> (&f)[4])
{
  using T = Lanes<W>;
  Pair<T> du_xi[2], du_eta[2], x_xi[2], x_eta[2]; // twice the derivatives
  to_points(u[1] - u[0], u[2] - u[3], du_xi);
  to_points(u[3] - u[0], u[2] - u[1], du_eta);
  PDX_UNROLL
  for (int k = 0; k < 2; ++k) {
    x_xi[k] = {load<W>(sides + 2 * k * W), load<W>(sides + (2 * k + 1) * W)};
    x_eta[k] = {load<W>(sides + (4 + 2 * k) * W), load<W>(sides + (5 + 2 * k) * W)};
  }
  T det[2][2], per_det[2][2]; // [i][j] at the point of x_eta[i], x_xi[j]
  PDX_UNROLL
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) det[i][j] = x_xi[j].x * x_eta[i].y - x_xi[j].y * x_eta[i].x;
  invert(det, per_det);
  T energy{};
  Pair<T> along[2] = {}, across[2] = {};
  PDX_UNROLL
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      const Pair<T> a = per_det[i][j] * (x_eta[i].y * du_xi[j] - x_xi[j].y * du_eta[i]); // du/dx
      const Pair<T> b = per_det[i][j] * (x_xi[j].x * du_eta[i] - x_eta[i].x * du_xi[j]); // du/dy
      T xx = a.x, yy = b.y, shear = a.y + b.x;
      if constexpr (finite) {
        xx += 0.5 * dot(a, a);
        yy += 0.5 * dot(b, b);
        shear += dot(a, b);
      }
      const T sx = m.c11 * xx + m.c12 * yy, sy = m.c12 * xx + m.c11 * yy, s = m.mu * shear;
      if constexpr (!forces) energy += (0.5 * det[i][j]) * (sx * xx + sy * yy + s * shear);
      if constexpr (forces) {
        Pair<T> px{sx, s}, py{s, sy};
        if constexpr (finite) {
          const Pair<T> fx{1.0 + a.x, a.y}, fy{b.x, 1.0 + b.y}; // columns of the deformation gradient
          px = sx * fx + s * fy;
          py = s * fx + sy * fy;
        }
        along[j] = along[j] + (x_eta[i].y * px - x_eta[i].x * py);
        across[i] = across[i] + (x_xi[j].x * py - x_xi[j].y * px);
      }
    }
  if constexpr (forces) to_corners(along, across, f);
  return energy;
}

/// Two neighbouring numbers at a time, from W places to a vector for each of both, and back.
///@{
typedef Lanes<2> Two;
PDX_INLINE Two two(const double* of, Index row) { return load<2>(of + 2 * static_cast<std::ptrdiff_t>(row)); }
template <int W> PDX_INLINE Lanes<W> every_second(const double* of, const Index* rows)
{
  if constexpr (W == 2)
    return two(of, rows[0]);
  else if constexpr (W == 4)
    return __builtin_shufflevector(two(of, rows[0]), two(of, rows[2]), 0, 1, 2, 3);
  else
    return __builtin_shufflevector(every_second<4>(of, rows), every_second<4>(of, rows + 4), 0, 1, 2, 3, 4, 5, 6, 7);
}
template <class V, std::size_t... L> PDX_INLINE Pair<V> halves(V even, V odd, std::index_sequence<L...>)
{
  constexpr int W = sizeof...(L);
  return {__builtin_shufflevector(even, odd, (L % 2 ? W + static_cast<int>(L) - 1 : static_cast<int>(L))...),
          __builtin_shufflevector(even, odd, (L % 2 ? W + static_cast<int>(L) : static_cast<int>(L) + 1)...)};
}
template <int W> PDX_INLINE Pair<Lanes<W>> take(const double* of, const Index* rows)
{
  return halves(every_second<W>(of, rows), every_second<W>(of, rows + 1), std::make_index_sequence<W>());
}
PDX_INLINE void put_two(Two x, double* to, Index row)
{
  double* const at = to + 2 * static_cast<std::ptrdiff_t>(row);
  store<2>(load<2>(at) + x, at);
}
template <int W, std::size_t... K>
PDX_INLINE void put(Lanes<W> even, Lanes<W> odd, double* to, const Index* rows, std::index_sequence<K...>)
{
  ((put_two(__builtin_shufflevector(even, even, 2 * K, 2 * K + 1), to, rows[2 * K]),
    put_two(__builtin_shufflevector(odd, odd, 2 * K, 2 * K + 1), to, rows[2 * K + 1])),
   ...);
}
template <int W> PDX_INLINE void put(const Pair<Lanes<W>>& x, double* to, const Index* rows)
{
  const Pair<Lanes<W>> pairs = halves(x.x, x.y, std::make_index_sequence<W>());
  put<W>(pairs.x, pairs.y, to, rows, std::make_index_sequence<W / 2>());
}
///@}

struct Sweep {
  const QuadBlocks& blocks;
  const Constants constants;
  Kinematics kinematics;
  const SweepFields& fields;
  double& energy;

  template <int W> PDX_INLINE void run() const
  {
    if (fields.r)
      kinematics == Kinematics::finite ? over_blocks<W, true, true>() : over_blocks<W, false, true>();
    else
      kinematics == Kinematics::finite ? over_blocks<W, true, false>() : over_blocks<W, false, false>();
  }

private:
  template <int W, bool finite, bool forces> PDX_INLINE void over_blocks() const
  {
    using T = Lanes<W>;
    T sum{};
    for (std::ptrdiff_t first = 0; first < blocks.elements; first += W) {
      const Index* const rows = blocks.rows.data() + 4 * first;
      Pair<T> u[4], f[4];
      PDX_UNROLL
      for (int a = 0; a < 4; ++a) u[a] = take<W>(fields.u, rows + a * W);
      const T energies = element<W, finite, forces>(constants, blocks.sides.data() + kSides * first, u, f);
      const std::ptrdiff_t count = std::min<std::ptrdiff_t>(W, blocks.elements - first);
      if constexpr (!forces) {
        if (count == W)
          sum += energies;
        else
          for (std::ptrdiff_t l = 0; l < count; ++l) sum[l] += energies[l];
      }
      if constexpr (forces) {
        if (blocks.inside && count == W) {
          PDX_UNROLL
          for (int a = 0; a < 4; ++a) put<W>(f[a], fields.r, rows + a * W);
        } else
          put_some<W>(f, rows, count);
      }
    }
    if constexpr (!forces)
      for (int l = 0; l < W; ++l) energy += sum[l];
  }
  template <int W> PDX_INLINE void put_some(const Pair<Lanes<W>> (&f)[4], const Index* rows, std::ptrdiff_t count) const
  {
    for (int a = 0; a < 4; ++a)
      for (std::ptrdiff_t l = 0; l < count; ++l) {
        const std::ptrdiff_t row = rows[a * W + l];
        if (row >= fields.owned) continue;
        fields.r[2 * row] += f[a].x[l];
        fields.r[2 * row + 1] += f[a].y[l];
      }
  }
};
} // namespace quads

QuadBlocks quad_blocks(Processor processor, std::span<const std::array<Vector<2>, 4>> corners,
                       std::span<const std::array<Index, 4>> rows)
{
  const auto lanes = static_cast<std::size_t>(lanes_of(processor));
  QuadBlocks blocks;
  blocks.elements = static_cast<Index>(corners.size());
  const std::size_t padded = (corners.size() + lanes - 1) / lanes * lanes;
  blocks.rows.resize(4 * padded);
  blocks.sides.resize(quads::kSides * padded);
  for (std::size_t k = 0; k < padded; ++k) {
    const std::size_t cell = std::min(k, corners.size() - 1), first = k / lanes * lanes, lane = k % lanes;
    const std::array<Vector<2>, 4>& x = corners[cell];
    for (std::size_t a = 0; a < 4; ++a) blocks.rows[4 * first + a * lanes + lane] = rows[cell][a];
    for (Eigen::Index d = 0; d < 2; ++d) {
      double by_xi[2], by_eta[2];
      to_points(x[1][d] - x[0][d], x[2][d] - x[3][d], by_xi);
      to_points(x[3][d] - x[0][d], x[2][d] - x[1][d], by_eta);
      for (std::size_t g = 0; g < 2; ++g) {
        double* const to = blocks.sides.data() + quads::kSides * first + (2 * g + static_cast<std::size_t>(d)) * lanes;
        to[lane] = by_xi[g];
        to[4 * lanes + lane] = by_eta[g];
      }
    }
  }
  return blocks;
}

void add_sweep_forces(Processor processor, const QuadBlocks& blocks, const law::Elastic& law, Kinematics kinematics,
                      const SweepFields& fields)
{
  double energy = 0.0;
  run_on(processor, quads::Sweep{blocks, quads::Constants(law), kinematics, fields, energy});
}

double sweep_energy(Processor processor, const QuadBlocks& blocks, const law::Elastic& law, Kinematics kinematics,
                    const SweepFields& fields)
{
  double energy = 0.0;
  const SweepFields read{fields.u, fields.rows, nullptr, 0};
  run_on(processor, quads::Sweep{blocks, quads::Constants(law), kinematics, read, energy});
  return energy;
}
} // namespace pdx::fem
