#include "pdx/field/history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pdx::field {
History History::step(double begin)
{
  History h;
  h.points_ = {{begin, 0.0}, {begin, 1.0}};
  return h;
}

History History::ramp(double begin, double width)
{
  History h;
  h.points_ = {{begin, 0.0}, {begin + width, 1.0}};
  return h;
}

History History::gaussian(double centre, double width)
{
  History h;
  h.shape_ = Shape::gaussian;
  h.centre_ = centre;
  h.width_ = width;
  return h;
}

History History::table(std::vector<Point> points)
{
  History h;
  h.points_ = std::move(points);
  return h;
}

double History::value(double time) const
{
  if (shape_ == Shape::gaussian) return std::exp(-std::pow((time - centre_) / width_, 2));
  const auto after = std::ranges::upper_bound(points_, time, {}, &Point::time);
  if (after == points_.begin()) return points_.front().factor;
  if (after == points_.end()) return points_.back().factor;
  const Point a = *(after - 1), b = *after;
  return a.factor + (b.factor - a.factor) * (time - a.time) / (b.time - a.time);
}

double History::rate(double time) const
{
  if (shape_ == Shape::gaussian) return -2.0 * (time - centre_) / (width_ * width_) * value(time);
  const auto after = std::ranges::upper_bound(points_, time, {}, &Point::time);
  if (after == points_.begin() || after == points_.end()) return 0.0;
  const Point a = *(after - 1), b = *after;
  return (b.factor - a.factor) / (b.time - a.time);
}

double History::integral(double time) const
{
  if (shape_ == Shape::gaussian)
    return 0.5 * std::sqrt(std::numbers::pi) * width_ *
           (std::erf((time - centre_) / width_) - std::erf(-centre_ / width_));
  double sum = 0.0, at = 0.0;
  for (const Point& p : points_) { // trapezoids up to each kink
    const double end = std::clamp(p.time, at, time);
    sum += 0.5 * (value(at) + value(std::nextafter(end, at))) * (end - at);
    at = end;
  }
  return sum + value(at) * (time - at);
}
} // namespace pdx::field
