#pragma once
#include "pdx/law/temperature_table.hpp"

#include <array>
#include <limits>
#include <memory>

namespace pdx::options {
struct SceneOptions;

/// Which temperatures the body goes through. uniform: everywhere alike, from `initial` to `ambient` in even steps of
/// the load. quench: a rectangle cooled on some sides, `law::Cooling`. file: a table over time and place.
enum class ThermalField { none, uniform, quench, file };

/// Heat that strains the body, `-thermal_...`: temperatures are known beforehand and feel nothing of what the body
/// does.
struct ThermalOptions {
  ThermalField field = ThermalField::none;
  double expansion = 0.0;    ///< linear, alpha                                     [1/K]
  double initial = 0.0;      ///< without stress                                    [K]
  double ambient = 0.0;      ///< of the medium; of uniform, at load 1              [K]
  double conductivity = 0.0; ///<                                                   [W/(m K)]
  double capacity = 0.0;     ///<                                                   [J/(kg K)]
  double transfer = std::numeric_limits<double>::infinity(); ///< through cooled sides             [W/(m^2 K)]
  std::array<bool, 4> cooled{};                              ///< left, right, bottom, top
  double duration = 0.0;                                     ///< time of the cooling at load 1                     [s]
  bool square = false;                                       ///< time grows with the square of the load, not evenly
  std::shared_ptr<const law::TemperatureTable> table;        ///< places as given

  bool active() const { return field != ThermalField::none; }
  double time(double load) const { return duration * (square ? load * load : load); } ///< [s]
  static ThermalOptions read(bool describe);
};

/// Refuses what heat cannot stand beside. Throws UserError.
void judge_thermal(const SceneOptions& options);
} // namespace pdx::options
