#pragma once
#include "pdx/base/processor.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

/// Bodies of kernels: compiled anew into each version of the function that calls them.
#define PDX_INLINE inline __attribute__((always_inline))
/// Before a loop of few, known turns whose variables must stay in registers.
#if defined(__clang__)
#define PDX_UNROLL
#else
#define PDX_UNROLL _Pragma("GCC unroll 16")
#endif

namespace pdx {
/// W neighbouring particles at once. Wider than the processor's registers is slow: the compiler goes through memory.
template <int W> struct Simd {
  typedef double Numbers
      __attribute__((vector_size(8 * W))); // GCC drops the attribute from a `using` that depends on W
  typedef std::uint64_t Words __attribute__((vector_size(8 * W)));
  typedef std::int64_t Mask __attribute__((vector_size(8 * W))); ///< -1 true, 0 false
};
template <int W> using Lanes = typename Simd<W>::Numbers;

template <int W> PDX_INLINE Lanes<W> load(const double* p)
{
  Lanes<W> x;
  __builtin_memcpy(&x, p, sizeof x);
  return x;
}
template <int W> PDX_INLINE typename Simd<W>::Words load(const std::uint64_t* p)
{
  typename Simd<W>::Words x;
  __builtin_memcpy(&x, p, sizeof x);
  return x;
}
template <int W> PDX_INLINE void store(Lanes<W> x, double* p) { __builtin_memcpy(p, &x, sizeof x); }
/// Square root to 2 ulp by four Newton steps on 1/sqrt(x) from its bit-shift estimate (3.5 % off): the steps share the
/// processor's multipliers with other bonds while its divider is busy, twice as fast as its square root. 0 gives 0.
template <int W> PDX_INLINE Lanes<W> square_root(Lanes<W> x)
{
  const typename Simd<W>::Words bits =
      std::uint64_t{0x5fe6eb50c7b537a9} - (std::bit_cast<typename Simd<W>::Words>(x) >> 1);
  Lanes<W> root = std::bit_cast<Lanes<W>>(bits); // 1/sqrt(x)
  const Lanes<W> half = 0.5 * x;
  PDX_UNROLL
  for (int step = 0; step < 4; ++step) root += root * (0.5 - half * root * root);
  return x * root;
}

/// Functions of a number T that is one double or lanes of them, for laws that are written once for both.
///@{
PDX_INLINE double root(double x) { return std::sqrt(x); }
template <class T> PDX_INLINE T root(T x) { return square_root<sizeof(T) / sizeof(double)>(x); }
PDX_INLINE bool any_true(bool mask) { return mask; }
template <class Mask> PDX_INLINE bool any_true(Mask mask)
{
  constexpr std::size_t W = sizeof(Mask) / sizeof(std::int64_t);
  if constexpr (W == 8) mask |= __builtin_shufflevector(mask, mask, 4, 5, 6, 7, 0, 1, 2, 3);
  if constexpr (W == 8) mask |= __builtin_shufflevector(mask, mask, 2, 3, 0, 1, 6, 7, 4, 5);
  if constexpr (W == 4) mask |= __builtin_shufflevector(mask, mask, 2, 3, 0, 1);
  return (mask[0] | mask[1]) != 0;
}
/// x - ln(1 + x), to rounding of itself for small x too; not a number for x <= -1.
template <class T> PDX_INLINE T log_shortfall(T x)
{
  if constexpr (std::is_same_v<T, double>) {
    const typename Simd<2>::Numbers both = {x, x};
    return log_shortfall(both)[0];
  } else {
    typedef typename Simd<sizeof(T) / sizeof(double)>::Mask Integers;
    const T one_more = 1.0 + x;
    const Integers bits = std::bit_cast<Integers>(one_more);
    const Integers power = (bits - std::int64_t{0x3fe6a09e667f3bcd}) >> 52; // 1 + x = 2^power m, m^2 in [1/2, 2)
    const T rest = power == 0 ? x : std::bit_cast<T>(bits - (power << 52)) - 1.0;
    const T z = rest / (2.0 + rest), square = z * z; // ln m = 2 artanh z, rest - 2 z = rest z
    T series = square * (1.0 / 21.0) + 1.0 / 19.0;
    PDX_UNROLL
    for (int k = 17; k >= 3; k -= 2) series = series * square + 1.0 / k;
    const T small = rest * z - 2.0 * z * square * series;
    const T large = x - (__builtin_convertvector(power, T) * 0.69314718055994530942 + rest - small);
    return one_more > 0.0 ? (power == 0 ? small : large) : T{} + std::numeric_limits<double>::quiet_NaN();
  }
}
///@}

/// Adds component d of particle l to rows[l * N + d] for the first `count` particles.
template <int W, int N> PDX_INLINE void add_rows(const Lanes<W> (&sum)[N], std::ptrdiff_t count, double* rows)
{
  if (count >= W) {
    for (int l = 0; l < W; ++l)
      for (int d = 0; d < N; ++d) rows[l * N + d] += sum[d][l];
    return;
  }
  for (std::ptrdiff_t l = 0; l < count; ++l)
    for (int d = 0; d < N; ++d) rows[l * N + d] += sum[d][l];
}

/// Runs `body.template run<W>()` in one version: 8 lanes with AVX-512, 4 with AVX2, else 2.
/// (GCC's target_clones would choose too, but cannot change W with the choice.)
#if defined(__x86_64__)
template <class Body> __attribute__((target("arch=x86-64-v4"))) void run_avx512(const Body& body)
{
  body.template run<8>();
}
template <class Body> __attribute__((target("arch=x86-64-v3"))) void run_avx2(const Body& body)
{
  body.template run<4>();
}
template <class Body> void run_on(Processor processor, const Body& body)
{
  if (processor == Processor::avx512)
    run_avx512(body);
  else if (processor == Processor::avx2)
    run_avx2(body);
  else
    body.template run<2>();
}
#else
template <class Body> void run_on(Processor, const Body& body) { body.template run<2>(); }
#endif
/// The same in the widest version for this machine.
template <class Body> void run_here(const Body& body) { run_on(this_processor(), body); }
} // namespace pdx
