#pragma once
#include <memory>
#include <string_view>
#include <vector>

namespace pdx::field {
/// How strongly something acts as time goes: a factor without unit. Pure; times in s.
class History {
public:
  /// 1 from the start.
  History() = default;
  /// 0 before `begin`, 1 from then on.
  static History step(double begin);
  /// 0 before `begin`, 1 after begin + width, straight in between.
  static History ramp(double begin, double width);
  /// exp(-((t - centre) / width)^2).
  static History gaussian(double centre, double width);
  /// Straight between points (time, factor) in ascending time; before the first and after the last as there.
  struct Point {
    double time, factor;
  };
  static History table(std::vector<Point> points);
  /// A formula of t, see `Expression`. Throws UserError. @param span over which it is summed up for `integral` at a
  /// time, above 0: so much of the time as it changes little in [s]
  static History expression(std::string_view text, double span);

  double value(double time) const;
  double rate(double time) const;     ///< its derivative; at a kink the one to come, at a jump 0 [1/s]
  double integral(double time) const; ///< from 0 to `time` >= 0 [s]

private:
  class Formula;
  enum class Shape { polyline, gaussian, expression };
  Shape shape_ = Shape::polyline;
  double centre_ = 0.0, width_ = 1.0; // gaussian
  std::vector<Point> points_{{0.0, 1.0}};
  std::shared_ptr<const Formula> formula_; // expression
};
} // namespace pdx::field
