#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace pdx {
/// XXH3 of some bytes, which may go on from those before.
std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t before = 0);

/// A number that tells contents apart, the same on every machine of one byte order.
class Fingerprint {
public:
  template <class Number> Fingerprint& add(std::span<const Number> values)
  {
    hash_ = hash_of(std::as_bytes(values), hash_);
    return *this;
  }
  std::uint64_t value() const { return hash_; }

private:
  std::uint64_t hash_ = 0;
};
} // namespace pdx
