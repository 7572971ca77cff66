#include "pdx/couple/carried_kernel.hpp"

#include "pdx/base/lanes.hpp"

namespace pdx::couple {
template <int Dim> void CarriedLanes<Dim>::add(std::size_t number, const Bond& bond)
{
  const std::size_t k = numbers_.size(), block = k / kBlock, l = k % kBlock;
  const auto hosts = static_cast<std::size_t>(width_);
  if (l == 0) { // a block of bonds that pull at nothing
    row_.resize((block + 1) * kBlock, bond.row);
    hosts_.resize((block + 1) * hosts * kBlock, bond.row);
    share_.resize((block + 1) * hosts * kBlock, 0.0);
    xi_.resize((block + 1) * Dim * kBlock, 1.0);
    length_.resize((block + 1) * kBlock, std::sqrt(static_cast<double>(Dim)));
    kappa_.resize((block + 1) * kBlock, 0.0);
    limit_.resize((block + 1) * kBlock, std::numeric_limits<double>::infinity());
  }
  numbers_.push_back(number);
  row_[k] = bond.row;
  for (std::size_t h = 0; h < bond.hosts.size(); ++h) {
    hosts_[(block * hosts + h) * kBlock + l] = bond.hosts[h];
    share_[(block * hosts + h) * kBlock + l] = bond.share[h];
  }
  for (std::size_t d = 0; d < Dim; ++d) xi_[(block * Dim + d) * kBlock + l] = bond.xi[static_cast<Eigen::Index>(d)];
  length_[k] = bond.xi.norm();
}

template <int Dim> void CarriedLanes<Dim>::set(std::size_t k, double kappa, double limit)
{
  kappa_[k] = kappa;
  limit_[k] = limit;
}

namespace carried_kernel {
/// Of W rows anywhere, each component by itself.
template <int W> PDX_INLINE void gather_pairs(const double* rows, const Index* at, Lanes<W> (&x)[2])
{
  typename Simd<2>::Numbers row[W];
  PDX_UNROLL
  for (int l = 0; l < W; ++l) row[l] = load<2>(rows + static_cast<std::ptrdiff_t>(at[l]) * 2);
  if constexpr (W == 2) {
    x[0] = __builtin_shufflevector(row[0], row[1], 0, 2);
    x[1] = __builtin_shufflevector(row[0], row[1], 1, 3);
  } else {
    typename Simd<4>::Numbers two[W / 2];
    PDX_UNROLL
    for (int l = 0; l < W / 2; ++l) two[l] = __builtin_shufflevector(row[2 * l], row[2 * l + 1], 0, 1, 2, 3);
    if constexpr (W == 4) {
      x[0] = __builtin_shufflevector(two[0], two[1], 0, 2, 4, 6);
      x[1] = __builtin_shufflevector(two[0], two[1], 1, 3, 5, 7);
    } else {
      const Lanes<8> low = __builtin_shufflevector(two[0], two[1], 0, 1, 2, 3, 4, 5, 6, 7);
      const Lanes<8> high = __builtin_shufflevector(two[2], two[3], 0, 1, 2, 3, 4, 5, 6, 7);
      x[0] = __builtin_shufflevector(low, high, 0, 2, 4, 6, 8, 10, 12, 14);
      x[1] = __builtin_shufflevector(low, high, 1, 3, 5, 7, 9, 11, 13, 15);
    }
  }
}
template <int W, int Dim> PDX_INLINE void gather(const double* rows, const Index* at, Lanes<W> (&x)[Dim])
{
  if constexpr (Dim == 2) {
    gather_pairs<W>(rows, at, x);
  } else {
    double by_lane[Dim][W];
    for (int l = 0; l < W; ++l)
      for (int d = 0; d < Dim; ++d) by_lane[d][l] = rows[static_cast<std::ptrdiff_t>(at[l]) * Dim + d];
    for (int d = 0; d < Dim; ++d) x[d] = load<W>(by_lane[d]);
  }
}

/// Adds to the owned ones of W rows anywhere, one after the other: some may be the same.
template <int W, int Dim> PDX_INLINE void scatter(double* rows, const Index* at, Index owned, const Lanes<W> (&x)[Dim])
{
  PDX_UNROLL
  for (int l = 0; l < W; ++l) {
    if (at[l] >= owned) continue;
    double* const row = rows + static_cast<std::ptrdiff_t>(at[l]) * Dim;
    if constexpr (Dim == 2) {
      const typename Simd<2>::Numbers one = {x[0][l], x[1][l]};
      store<2>(load<2>(row) + one, row);
    } else {
      for (int d = 0; d < Dim; ++d) row[d] += x[d][l];
    }
  }
}
} // namespace carried_kernel

/// s = e / (L (L + y)) with e = 2 xi.eta + eta.eta and y^2 = L^2 + e, so that small stretches keep their digits; force
/// kappa s (xi + eta) / y. Linear: s = xi.eta / L^2, force along xi.
template <int Dim> struct SweepCarried {
  const CarriedLanes<Dim>& bonds;
  bool finite;
  const double* u;
  Index owned;
  double* r;
  bool& passed;

  template <int W> PDX_INLINE void run() const
  {
    if (bonds.width_ == 1)
      with_width<W, 1>();
    else if (bonds.width_ == 2)
      with_width<W, 2>();
    else
      with_width<W, 4>();
  }

private:
  static constexpr int kBlock = CarriedLanes<Dim>::kBlock;

  template <int W, int H> PDX_INLINE void with_width() const
  {
    typename Simd<W>::Mask over{};
    for (std::size_t at = 0; at < bonds.row_.size(); at += W) {
      const std::size_t block = at / kBlock, l0 = at % kBlock;
      const Index* const row = &bonds.row_[at];
      Lanes<W> eta[Dim], xi[Dim], there[Dim];
      carried_kernel::gather<W>(u, row, eta);
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) eta[d] = -eta[d];
      PDX_UNROLL
      for (int h = 0; h < H; ++h) {
        const std::size_t first = (block * H + static_cast<std::size_t>(h)) * kBlock + l0;
        carried_kernel::gather<W>(u, &bonds.hosts_[first], there);
        const Lanes<W> share = load<W>(&bonds.share_[first]);
        PDX_UNROLL
        for (int d = 0; d < Dim; ++d) eta[d] += share * there[d];
      }
      const Lanes<W> length = load<W>(&bonds.length_[at]), kappa = load<W>(&bonds.kappa_[at]);
      Lanes<W> along{}, square{};
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) {
        xi[d] = load<W>(&bonds.xi_[(block * Dim + static_cast<std::size_t>(d)) * kBlock + l0]);
        along += xi[d] * eta[d];
        square += eta[d] * eta[d];
      }
      Lanes<W> stretch, pull;
      if (finite) {
        const Lanes<W> excess = 2.0 * along + square, now = square_root<W>(length * length + excess);
        stretch = excess / (length * (length + now));
        pull = kappa * stretch / now;
        PDX_UNROLL
        for (int d = 0; d < Dim; ++d) xi[d] += eta[d];
      } else {
        stretch = along / (length * length);
        pull = kappa * stretch / length;
      }
      over |= stretch > load<W>(&bonds.limit_[at]);
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) xi[d] *= -pull;
      carried_kernel::scatter<W>(r, row, owned, xi);
      PDX_UNROLL
      for (int h = 0; h < H; ++h) {
        const std::size_t first = (block * H + static_cast<std::size_t>(h)) * kBlock + l0;
        const Lanes<W> share = load<W>(&bonds.share_[first]);
        PDX_UNROLL
        for (int d = 0; d < Dim; ++d) there[d] = -share * xi[d];
        carried_kernel::scatter<W>(r, &bonds.hosts_[first], owned, there);
      }
    }
    passed = any_true(over);
  }
};

template <int Dim>
bool CarriedLanes<Dim>::add_forces(Processor processor, bool finite, std::span<const double> u, Index owned,
                                   std::span<double> r) const
{
  bool passed = false;
  if (!numbers_.empty()) run_on(processor, SweepCarried<Dim>{*this, finite, u.data(), owned, r.data(), passed});
  return passed;
}

template class CarriedLanes<2>;
template class CarriedLanes<3>;
} // namespace pdx::couple
