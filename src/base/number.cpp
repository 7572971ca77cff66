#include "pdx/base/number.hpp"

#include <charconv>
#include <cmath>

namespace pdx {
namespace {
constexpr std::size_t kLongest = 400; // characters; 1e-308 in fixed notation has fewer

template <class Number> std::optional<Number> number_in(std::string_view word)
{
  if (word.size() > kLongest) return std::nullopt;
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}
} // namespace

std::optional<double> real_in(std::string_view word) { return number_in<double>(word); }

std::optional<std::int64_t> whole_in(std::string_view word)
{
  if (const auto plain = number_in<std::int64_t>(word)) return plain;
  const auto real = number_in<double>(word);
  constexpr double most = 9007199254740992.0; // 2^53: every whole number below is a double
  if (!real || std::trunc(*real) != *real || std::abs(*real) > most) return std::nullopt;
  return static_cast<std::int64_t>(*real);
}
} // namespace pdx
