#pragma once
#include "pdx/base/tensor.hpp"

#include <cstdint>

namespace pdx::field {
/// What a row is, whatever rank holds it and whatever else a scene holds: 64 bits, ordered by kind, then by key.
class RowName {
public:
  enum class Kind : std::uint8_t { none, node, set, particle };

  constexpr RowName() = default; ///< no row
  static constexpr RowName node(Index natural_vertex)
  {
    return {Kind::node, static_cast<std::uint64_t>(natural_vertex)};
  }
  static constexpr RowName set(Index natural_vertex, int crack)
  {
    return {Kind::set, static_cast<std::uint64_t>(natural_vertex) << kCrackBits | static_cast<std::uint64_t>(crack)};
  }
  /// @param site name of a lattice site (geom::SiteNames), or a cloud's number, below 2^62
  static constexpr RowName particle(std::uint64_t site) { return {Kind::particle, site}; }
  static constexpr RowName from(std::uint64_t value)
  {
    RowName name;
    name.value_ = value;
    return name;
  }

  constexpr Kind kind() const { return static_cast<Kind>(value_ >> kKeyBits); }
  constexpr std::uint64_t key() const { return value_ & ((std::uint64_t{1} << kKeyBits) - 1); }
  constexpr std::uint64_t value() const { return value_; } ///< 0: no row
  constexpr bool operator==(const RowName& other) const { return value_ == other.value_; }
  constexpr bool operator<(const RowName& other) const { return value_ < other.value_; }

private:
  static constexpr int kKeyBits = 62, kCrackBits = 24;
  constexpr RowName(Kind kind, std::uint64_t key) : value_(static_cast<std::uint64_t>(kind) << kKeyBits | key) {}
  std::uint64_t value_ = 0;
};
} // namespace pdx::field
