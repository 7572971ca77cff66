#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace pdx {
/// The number that a whole word is, a leading + allowed, NaN and infinity among them; none: it is no number, or one
/// beyond the range of doubles.
std::optional<double> real_in(std::string_view word);
/// The whole number that a word is, in any notation: 12, +12, 12.0, 1.2e1.
std::optional<std::int64_t> whole_in(std::string_view word);
} // namespace pdx
