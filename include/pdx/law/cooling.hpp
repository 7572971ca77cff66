#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/geom/box.hpp"

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace pdx::law {
/// A plane wall that is as warm everywhere at first and is cooled on one face, by a medium to which heat passes in
/// proportion to the difference; the other face is insulated (or the middle of a wall cooled on both). Of the
/// difference of temperatures at first this share is left [Incropera, DeWitt: Fundamentals of Heat and Mass Transfer,
/// ch. 5.5, 5.7]:
///   sum_n C_n cos(z_n (1 - d)) exp(-z_n^2 Fo),  z tan z = Bi,  C = 4 sin z / (2 z + sin 2 z)
/// and while the insulated face knows nothing yet, that of a half space
///   erf(g) + exp(Bi d + Bi^2 Fo) erfc(g + Bi sqrt(Fo)),  g = d / (2 sqrt(Fo)).
class CooledWall {
public:
  /// @param biot Bi = transfer coefficient x width / conductivity; infinite: the face takes on the medium's temperature
  ///        at once [-]
  explicit CooledWall(double biot);
  /// @param depth below the cooled face over the width, 0 to 1   @param fourier Fo = diffusivity x time / width^2  [-]
  double share(double depth, double fourier) const;

private:
  double in_half_space(double depth, double fourier) const;
  double biot_;
  std::vector<double> roots_; ///< z_n, ascending
};

/// A rectangle that is as warm everywhere at first and is cooled on some of its sides, insulated on the others: the
/// product of two walls.
class Cooling {
public:
  struct Data {
    geom::Box<2> body;            ///< [m]
    std::array<bool, 4> cooled{}; ///< left, right, bottom, top
    double diffusivity = 0.0;     ///< conductivity / (density x heat capacity)             [m^2/s]
    double conductivity = 0.0;    ///<                                                      [W/(m K)]
    double transfer = 0.0;        ///< of heat through cooled sides; infinite: at once      [W/(m^2 K)]
  };
  explicit Cooling(const Data& data);
  /// Share of the difference of temperatures that is left at a time [s], by place [m]. Places on common lines along x
  /// or y are worked out once for each line. Good as long as this is.
  std::function<double(const Vector<2>&)> share(double time) const;

private:
  struct Direction {
    double lower, upper, width; ///< width of the wall, cooled on one side [m]
    bool from_lower, from_upper;
    CooledWall wall;
    double share(double x, double diffusivity, double time) const;
  };
  std::array<std::optional<Direction>, 2> directions_; // none: insulated on both sides
  double diffusivity_;
};
} // namespace pdx::law
