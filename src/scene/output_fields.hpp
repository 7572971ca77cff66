#pragma once
#include "pdx/field/output_field.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace pdx::scene {
/// Dim components, the others 0.
template <int Dim> std::array<double, 3> padded(const double* x)
{
  std::array<double, 3> all{};
  std::copy_n(x, Dim, all.begin());
  return all;
}

/// A vector field of the first `count` blocks.
template <int Dim> field::OutputField vector_field(const char* name, std::span<const double> blocks, std::size_t count)
{
  field::OutputField f{name, field::Rank::vector, false, false, {}};
  for (std::size_t k = 0; k < count; ++k) {
    const auto value = padded<Dim>(&blocks[Dim * k]);
    f.values.insert(f.values.end(), value.begin(), value.end());
  }
  return f;
}

template <int Dim> field::OutputField displacement_field(std::span<const double> blocks, std::size_t count)
{
  return vector_field<Dim>("displacement [m]", blocks, count);
}
} // namespace pdx::scene
