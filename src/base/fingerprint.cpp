#include "pdx/base/fingerprint.hpp"

#include <xxhash.h>

namespace pdx {
std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t before)
{
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), before);
}
} // namespace pdx
