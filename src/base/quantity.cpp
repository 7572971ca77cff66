#include "pdx/base/quantity.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/number.hpp"
#include "pdx/base/shown.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace pdx {
namespace {
struct NamedUnit {
  std::string_view name;
  Unit unit;
  bool prefixed; ///< takes k, m, ...
};
constexpr std::array<NamedUnit, 16> kUnits{{{"m", {0, 1, 0, 1.0}, true},
                                            {"g", {1, 0, 0, 1e-3}, true},
                                            {"t", {1, 0, 0, 1e3}, false},
                                            {"s", {0, 0, 1, 1.0}, true},
                                            {"min", {0, 0, 1, 60.0}, false},
                                            {"h", {0, 0, 1, 3600.0}, false},
                                            {"N", {1, 1, -2, 1.0}, true},
                                            {"Pa", {1, -1, -2, 1.0}, true},
                                            {"J", {1, 2, -2, 1.0}, true},
                                            {"W", {1, 2, -3, 1.0}, true},
                                            {"Hz", {0, 0, -1, 1.0}, true},
                                            {"K", {0, 0, 0, 1.0, 1}, true},
                                            {"%", {0, 0, 0, 1e-2}, false},
                                            {"rad", {0, 0, 0, 1.0}, false},
                                            {"deg", {0, 0, 0, 0.017453292519943295}, false},
                                            {"1", {0, 0, 0, 1.0}, false}}};
struct Prefix {
  std::string_view name;
  double factor;
};
constexpr std::array<Prefix, 9> kPrefixes{{{"n", 1e-9},
                                           {"u", 1e-6},
                                           {"\xC2\xB5", 1e-6}, // the micro sign and the Greek letter
                                           {"\xCE\xBC", 1e-6},
                                           {"m", 1e-3},
                                           {"c", 1e-2},
                                           {"k", 1e3},
                                           {"M", 1e6},
                                           {"G", 1e9}}};

std::optional<Unit> plain_unit(std::string_view word)
{
  for (const NamedUnit& known : kUnits)
    if (word == known.name) return known.unit;
  for (const Prefix& prefix : kPrefixes) {
    if (!word.starts_with(prefix.name)) continue;
    for (const NamedUnit& known : kUnits)
      if (known.prefixed && word.substr(prefix.name.size()) == known.name) {
        Unit unit = known.unit;
        unit.factor *= prefix.factor;
        return unit;
      }
  }
  return std::nullopt;
}

/// A unit with its power: "m", "mm^2", "s2", "m^-1".
std::optional<Unit> powered(std::string_view word)
{
  std::size_t end = word.size();
  while (end > 1 && std::isdigit(static_cast<unsigned char>(word[end - 1]))) --end;
  std::string_view digits = word.substr(end);
  if (!digits.empty() && end > 1 && word[end - 1] == '-') digits = word.substr(--end);
  int power = 1;
  if (!digits.empty() && std::from_chars(digits.data(), digits.data() + digits.size(), power).ec != std::errc())
    return std::nullopt;
  if (!digits.empty() && end > 1 && word[end - 1] == '^') --end;
  if (std::abs(power) > 9) return std::nullopt;
  auto unit = plain_unit(word.substr(0, end));
  if (!unit) return std::nullopt;
  return Unit{unit->kilogram * power, unit->metre * power, unit->second * power, std::pow(unit->factor, power),
              unit->kelvin * power};
}

Unit product(const Unit& a, const Unit& b, int sign)
{
  return {a.kilogram + sign * b.kilogram, a.metre + sign * b.metre, a.second + sign * b.second,
          sign > 0 ? a.factor * b.factor : a.factor / b.factor, a.kelvin + sign * b.kelvin};
}

/// A factor that is whole but for rounding.
double whole(double factor)
{
  const double nearest = std::round(factor);
  return std::abs(factor - nearest) < 1e-12 * factor ? nearest : factor;
}

std::string described(const char* wanted)
{
  const std::string_view unit = wanted;
  return unit.empty() || unit == "-" ? "a number without a unit belongs there"
                                     : fmt::format("a value in {} or a multiple of it belongs there", unit);
}
} // namespace

std::optional<Unit> unit_in(std::string_view word)
{
  if (word.empty() || word == "-") return Unit{};
  Unit all;
  int sign = word[0] == '/' ? -1 : 1; // 3/m: three per metre
  for (std::size_t from = word[0] == '/' ? 1 : 0; from <= word.size();) {
    const std::size_t end = std::min(word.find_first_of("/*.", from), word.size());
    const auto part = powered(word.substr(from, end - from));
    if (!part) return std::nullopt;
    all = product(all, *part, sign);
    if (end == word.size()) return all;
    sign = word[end] == '/' ? -1 : 1;
    from = end + 1;
  }
  return std::nullopt;
}

std::optional<Quantity> quantity_in(std::string_view word)
{
  constexpr std::size_t kLongest = 400;
  if (word.size() > kLongest) return std::nullopt;
  if (const auto number = real_in(word)) return Quantity{*number, ""};
  std::string_view rest = word;
  if (rest.size() > 1 && rest[0] == '+' && rest[1] != '-') rest.remove_prefix(1);
  double number = 0.0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (error != std::errc() || !std::isfinite(number)) return std::nullopt; // inf and nan have letters of their own
  const char* behind = end;
  const char* last = rest.data() + rest.size();
  if (last - behind > 1 && *behind == '/' && std::isdigit(static_cast<unsigned char>(behind[1]))) { // 1/3
    double divisor = 0.0;
    const auto [stop, fault] = std::from_chars(behind + 1, last, divisor);
    if (fault != std::errc() || !std::isfinite(number / divisor)) return std::nullopt;
    number /= divisor;
    behind = stop;
  }
  return Quantity{number, std::string(behind, last)};
}

std::optional<double> value_in(std::string_view word, const char* wanted)
{
  const auto quantity = quantity_in(word);
  if (!quantity) return std::nullopt;
  if (quantity->unit.empty()) return quantity->number;
  const auto unit = unit_in(quantity->unit);
  if (!unit) return std::nullopt;
  const auto other = unit_in(wanted);
  if (!other || !unit->same_kind(*other))
    throw UserError(fmt::format("\"{}\" is of the wrong kind: {}", shown(quantity->unit), described(wanted)));
  // Divided by a whole number where that is exact: 72.5mm is the double nearest to 0.0725.
  return unit->factor < 1.0 ? quantity->number / whole(1.0 / unit->factor) : quantity->number * whole(unit->factor);
}
} // namespace pdx
