#include "pdx/base/processor.hpp"

#include "pdx/base/error.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <string>

namespace pdx {
namespace {
Processor find_processor()
{
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return Processor::any;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
                    __builtin_cpu_supports("avx512vl");
  return wide ? Processor::avx512 : Processor::avx2;
#else
  return Processor::any;
#endif
}

Processor named(const std::string& name)
{
  if (name == "avx512") return Processor::avx512;
  if (name == "avx2") return Processor::avx2;
  if (name == "portable") return Processor::any;
  throw UserError(fmt::format("PDX_SIMD is '{}': must be avx512, avx2 or portable", name));
}
} // namespace

Processor this_processor()
{
  static const Processor processor = find_processor();
  return processor;
}

Processor chosen_processor()
{
  const char* wish = std::getenv("PDX_SIMD");
  if (!wish || !*wish) return this_processor();
  const Processor processor = named(wish);
  if (processor > this_processor())
    throw UserError(fmt::format("PDX_SIMD is {}, which this machine's processor does not have", wish));
  return processor;
}
} // namespace pdx
