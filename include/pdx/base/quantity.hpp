#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace pdx {
/// What a unit measures, as powers of kg, m, s and K, and how many of the SI unit it is.
struct Unit {
  int kilogram = 0, metre = 0, second = 0;
  double factor = 1.0; ///< [-]
  int kelvin = 0;
  bool same_kind(const Unit& other) const
  {
    return kilogram == other.kilogram && metre == other.metre && second == other.second && kelvin == other.kelvin;
  }
};

/// The unit that a word is: m, g, s, N, Pa, J, W, Hz, K with a prefix or none (n u m c k M G), min, h, %, and products
/// and quotients of them with powers: kg/m^3, J/m2, N/mm^2, m/s. "-" and "" are 1. None: it is no unit.
std::optional<Unit> unit_in(std::string_view word);

/// A number, or a quotient of two (1/3), and what stands directly behind: "72GPa" is 72 and "GPa". None: it does not
/// begin with a number.
struct Quantity {
  double number = 0.0;
  std::string unit; ///< "": none was given, the value is in SI units
};
std::optional<Quantity> quantity_in(std::string_view word);

/// What such a word is in the SI unit `wanted`; none where it is no number. Throws UserError, without the name of the
/// option in front, for a unit that is none or measures something else.
std::optional<double> value_in(std::string_view word, const char* wanted);
} // namespace pdx
