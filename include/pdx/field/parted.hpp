#pragma once
#include "pdx/base/tensor.hpp"

#include <span>

namespace pdx::field {
/// What a Term is besides whose force can be parted by elements, for steps that feel what is far less often.
class Parted {
public:
  virtual ~Parted() = default;
  /// Elements with a marked row are near, and mark all their rows in `near`; the others are far from now on.
  /// @param marked, near one entry per local row
  virtual void part(std::span<const std::uint8_t> marked, std::span<std::uint8_t> near) = 0;
  /// As `Term::add_residual`, of what is near alone, and of what is far. Before `part` all is near.
  ///@{
  virtual void add_near(std::span<const double> u, std::span<double> r) const = 0;
  virtual void add_far(std::span<const double> u, std::span<double> r) const = 0;
  ///@}
  /// As `Term::add_stiffness_bound`, of what is far.
  virtual void add_far_bound(std::span<double> blocks) const = 0;
};
} // namespace pdx::field
