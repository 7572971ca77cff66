#include "pdx/geom/frame.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::geom {
namespace {
constexpr double kFinest = 1e-14;             // of the body's size
constexpr double kWhole = 4503599627370496.0; // 2^52: from here on all numbers are whole
} // namespace

Frame::Frame(const Box<3>& body) : origin_(body.lower)
{
  const double far = std::max(body.lower.cwiseAbs().maxCoeff(), body.upper.cwiseAbs().maxCoeff());
  const double least = std::max(2.0 * far * std::numeric_limits<double>::epsilon(), kFinest * body.size().maxCoeff());
  if (least > 0.0 && std::isfinite(least)) steps_per_unit_ = std::pow(10.0, -std::ceil(std::log10(least)));
}

Frame::Frame(const Box<2>& body)
    : Frame(Box<3>{{body.lower[0], body.lower[1], 0.0}, {body.upper[0], body.upper[1], 0.0}})
{}

/// By a division, where the power of ten is exact: the nearest number to the decimal, as if it had been typed.
double Frame::rounded(double x) const
{
  if (steps_per_unit_ <= 0.0 || !(std::abs(x) * steps_per_unit_ < kWhole)) return x;
  if (steps_per_unit_ >= 1.0) return std::round(x * steps_per_unit_) / steps_per_unit_;
  const double step = std::round(1.0 / steps_per_unit_);
  return std::round(x / step) * step;
}

std::string Frame::text(const Vector<2>& inside) const
{
  const Vector<2> x = given<2>(inside);
  return fmt::format("({:.10g}, {:.10g})", x.x(), x.y());
}
} // namespace pdx::geom
