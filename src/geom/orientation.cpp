#include "pdx/geom/orientation.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace pdx::geom {
namespace {
constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2.0;
constexpr double kBound = (3.0 + 16.0 * kUnit) * kUnit; // relative error of the plain determinant (Shewchuk, sec. 4.3)

struct Product {
  double high, low; ///< their sum is the product, exactly
};
/// Not inlined: a compiler that merged the product into a following sum would undo the exactness of that sum.
[[gnu::noinline]] Product multiply(double x, double y)
{
  const double high = x * y;
  return {high, std::fma(x, y, -high)};
}

/// Sum of up to 12 doubles without rounding: components that do not overlap, in growing order.
class ExactSum {
public:
  void add(double term)
  {
    for (std::size_t k = 0; k < size_; ++k) {
      const double sum = term + parts_[k], of_part = sum - term;
      parts_[k] = (term - (sum - of_part)) + (parts_[k] - of_part); // what the sum lost
      term = sum;
    }
    parts_[size_++] = term;
  }
  int sign() const
  {
    for (std::size_t k = size_; k-- > 0;)
      if (parts_[k] != 0.0) return parts_[k] > 0.0 ? 1 : -1;
    return 0;
  }

private:
  std::array<double, 12> parts_{};
  std::size_t size_ = 0;
};

int exact_orientation(const Vector<2>& a, const Vector<2>& b, const Vector<2>& c)
{
  ExactSum sum;
  const auto add_cross = [&sum](const Vector<2>& p, const Vector<2>& q) {
    for (const Product& product : {multiply(p.x(), q.y()), multiply(-p.y(), q.x())}) {
      sum.add(product.low);
      sum.add(product.high);
    }
  };
  add_cross(a, b);
  add_cross(b, c);
  add_cross(c, a);
  return sum.sign();
}
} // namespace

int orientation(const Vector<2>& a, const Vector<2>& b, const Vector<2>& c)
{
  const double left = (a.x() - c.x()) * (b.y() - c.y()), right = (a.y() - c.y()) * (b.x() - c.x());
  const double determinant = left - right;
  if (std::abs(determinant) > kBound * (std::abs(left) + std::abs(right))) return determinant > 0.0 ? 1 : -1;
  return exact_orientation(a, b, c);
}
} // namespace pdx::geom
