#include "pdx/field/history.hpp"

#include "pdx/field/expression.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pdx::field {
/// A formula, and its integral over spans of time from 0 on.
class History::Formula {
public:
  Formula(std::string_view text, double span) : expression_(text), span_(span) {}
  Expression::Value at(double time) const { return expression_.at(time); }
  /// Spans are the same whatever times are asked for, so that the answer is too.
  double integral(double time) const
  {
    const double whole = std::floor(time / span_);
    const auto spans = static_cast<std::size_t>(whole);
    while (sums_.size() <= spans) {
      const auto k = static_cast<double>(sums_.size());
      sums_.push_back(sums_.back() + between((k - 1.0) * span_, k * span_));
    }
    return sums_[spans] + between(whole * span_, time);
  }

private:
  /// Simpson's rule on halves of halves, until they say the same.
  double between(double a, double b) const
  {
    if (!(b > a)) return 0.0;
    constexpr int begin = 4; // parts at least, so that no short pulse hides between three points
    double sum = 0.0;
    for (int k = 0; k < begin; ++k) {
      const double from = a + (b - a) * k / begin, to = a + (b - a) * (k + 1) / begin;
      sum += refined(from, to, value(from), value(0.5 * (from + to)), value(to), 0);
    }
    return sum;
  }
  double value(double time) const { return expression_.at(time).value; }
  double refined(double a, double b, double fa, double fm, double fb, int depth) const
  {
    constexpr int deepest = 40;
    constexpr double near = 1e-12; // of the largest value there
    const double m = 0.5 * (a + b), left = value(0.5 * (a + m)), right = value(0.5 * (m + b));
    const double coarse = (b - a) / 6.0 * (fa + 4.0 * fm + fb);
    const double fine = (b - a) / 12.0 * (fa + 4.0 * left + 2.0 * fm + 4.0 * right + fb);
    const double size = std::max({std::abs(fa), std::abs(fm), std::abs(fb), std::abs(left), std::abs(right)});
    if (depth >= deepest || !(std::abs(fine - coarse) > near * size * (b - a))) return fine + (fine - coarse) / 15.0;
    return refined(a, m, fa, left, fm, depth + 1) + refined(m, b, fm, right, fb, depth + 1);
  }

  Expression expression_;
  double span_;
  mutable std::vector<double> sums_{0.0}; // up to the beginning of each span [s]
};

History History::expression(std::string_view text, double span)
{
  History h;
  h.shape_ = Shape::expression;
  h.formula_ = std::make_shared<const Formula>(text, span);
  return h;
}

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
  if (shape_ == Shape::expression) return formula_->at(time).value;
  if (shape_ == Shape::gaussian) return std::exp(-std::pow((time - centre_) / width_, 2));
  const auto after = std::ranges::upper_bound(points_, time, {}, &Point::time);
  if (after == points_.begin()) return points_.front().factor;
  if (after == points_.end()) return points_.back().factor;
  const Point a = *(after - 1), b = *after;
  return a.factor + (b.factor - a.factor) * (time - a.time) / (b.time - a.time);
}

double History::rate(double time) const
{
  if (shape_ == Shape::expression) return formula_->at(time).rate;
  if (shape_ == Shape::gaussian) return -2.0 * (time - centre_) / (width_ * width_) * value(time);
  const auto after = std::ranges::upper_bound(points_, time, {}, &Point::time);
  if (after == points_.begin() || after == points_.end()) return 0.0;
  const Point a = *(after - 1), b = *after;
  return (b.factor - a.factor) / (b.time - a.time);
}

double History::integral(double time) const
{
  if (shape_ == Shape::expression) return formula_->integral(time);
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
