#pragma once

namespace pdx {
/// The versions that kernels of lanes are built in: 2, 4 (AVX2) and 8 lanes (AVX-512) of doubles.
enum class Processor { any, avx2, avx512 };

/// The widest version this machine can run.
Processor this_processor();
/// The version explicit steps run in: the environment's PDX_SIMD (avx512, avx2 or portable), else the widest.
/// Throws UserError for another word, and for a version this machine cannot run.
Processor chosen_processor();
constexpr int lanes_of(Processor processor)
{
  return processor == Processor::avx512 ? 8 : processor == Processor::avx2 ? 4 : 2;
}
} // namespace pdx
