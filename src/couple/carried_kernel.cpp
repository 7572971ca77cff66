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
      Lanes<W> eta[Dim], xi[Dim];
      double gathered[Dim][W];
      for (int l = 0; l < W; ++l)
        for (int d = 0; d < Dim; ++d) gathered[d][l] = -u[static_cast<std::ptrdiff_t>(row[l]) * Dim + d];
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) eta[d] = load<W>(gathered[d]);
      PDX_UNROLL
      for (int h = 0; h < H; ++h) {
        const std::size_t first = (block * H + static_cast<std::size_t>(h)) * kBlock + l0;
        const Index* const host = &bonds.hosts_[first];
        for (int l = 0; l < W; ++l)
          for (int d = 0; d < Dim; ++d) gathered[d][l] = u[static_cast<std::ptrdiff_t>(host[l]) * Dim + d];
        const Lanes<W> share = load<W>(&bonds.share_[first]);
        PDX_UNROLL
        for (int d = 0; d < Dim; ++d) eta[d] += share * load<W>(gathered[d]);
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
      double force[Dim][W];
      PDX_UNROLL
      for (int d = 0; d < Dim; ++d) store<W>(pull * xi[d], force[d]);
      for (int l = 0; l < W; ++l)
        if (row[l] < owned)
          for (int d = 0; d < Dim; ++d) r[static_cast<std::ptrdiff_t>(row[l]) * Dim + d] -= force[d][l];
      PDX_UNROLL
      for (int h = 0; h < H; ++h) {
        const std::size_t first = (block * H + static_cast<std::size_t>(h)) * kBlock + l0;
        const Index* const host = &bonds.hosts_[first];
        const double* const share = &bonds.share_[first];
        for (int l = 0; l < W; ++l)
          if (host[l] < owned)
            for (int d = 0; d < Dim; ++d) r[static_cast<std::ptrdiff_t>(host[l]) * Dim + d] += share[l] * force[d][l];
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
