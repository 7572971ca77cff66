#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>

/// Bodies of kernels: compiled anew into each version of the function that calls them.
#define PDX_INLINE inline __attribute__((always_inline))
/// Outer function of a kernel: one version per generation of processors, chosen when the program starts.
/// clang-tidy cannot parse it; the sanitizers cannot run the code that chooses.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define PDX_EVERY_CPU __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define PDX_EVERY_CPU
#endif

/// Before a loop of few, known turns whose variables must stay in registers.
#if defined(__clang__)
#define PDX_UNROLL
#else
#define PDX_UNROLL _Pragma("GCC unroll 16")
#endif

namespace pdx::pd {
/// Eight neighbouring particles at once.
inline constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(64)));
using WordLanes = std::uint64_t __attribute__((vector_size(64)));
using MaskLanes = std::int64_t __attribute__((vector_size(64))); ///< -1 true, 0 false

PDX_INLINE Lanes load(const double* p)
{
  using Unaligned = double __attribute__((vector_size(64), aligned(8), may_alias));
  return *reinterpret_cast<const Unaligned*>(p);
}
PDX_INLINE WordLanes load(const std::uint64_t* p)
{
  using Unaligned = std::uint64_t __attribute__((vector_size(64), aligned(8), may_alias));
  return *reinterpret_cast<const Unaligned*>(p);
}
/// Square root to 2 ulp by four Newton steps on 1/sqrt(x) from its bit-shift estimate (3.5 % off): the steps share the
/// processor's multipliers with other bonds while its divider is busy, twice as fast as its square root. 0 gives 0.
PDX_INLINE Lanes square_root(Lanes x)
{
  const WordLanes bits = std::uint64_t{0x5fe6eb50c7b537a9} - (std::bit_cast<WordLanes>(x) >> 1);
  Lanes root = std::bit_cast<Lanes>(bits); // 1/sqrt(x)
  const Lanes half = 0.5 * x;
  PDX_UNROLL
  for (int step = 0; step < 4; ++step) root += root * (0.5 - half * root * root);
  return x * root;
}
/// Adds component d of particle l to rows[l * N + d] for the first `count` particles.
template <int N> PDX_INLINE void add_rows(const Lanes (&sum)[N], std::ptrdiff_t count, double* rows)
{
  if (count >= kLanes) {
    for (int l = 0; l < kLanes; ++l)
      for (int d = 0; d < N; ++d) rows[l * N + d] += sum[d][l];
    return;
  }
  for (std::ptrdiff_t l = 0; l < count; ++l)
    for (int d = 0; d < N; ++d) rows[l * N + d] += sum[d][l];
}
} // namespace pdx::pd
