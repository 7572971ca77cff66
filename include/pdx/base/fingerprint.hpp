#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace pdx {
/// A number that tells contents apart, the same on every machine of one byte order: FNV-1a.
class Fingerprint {
public:
  template <class Number> Fingerprint& add(std::span<const Number> values)
  {
    for (const std::byte byte : std::as_bytes(values))
      hash_ = (hash_ ^ std::to_integer<std::uint64_t>(byte)) * 1099511628211u;
    return *this;
  }
  std::uint64_t value() const { return hash_; }

private:
  std::uint64_t hash_ = 14695981039346656037u;
};
} // namespace pdx
