#include "pdx/mesh/locate.hpp"

#include <Eigen/LU>
#include <cmath>

namespace pdx::mesh {
namespace {
/// A sum of doubles kept without rounding, smallest part first (Shewchuk 1997, Grow-Expansion).
class ExactSum {
public:
  void add(double x)
  {
    for (int k = 0; k < size_; ++k) {
      const double sum = x + parts_[k], back = sum - x;
      parts_[k] = (x - (sum - back)) + (parts_[k] - back);
      x = sum;
    }
    parts_[size_++] = x;
  }
  void add_product(double a, double b)
  {
    const double product = a * b;
    add(std::fma(a, b, -product));
    add(product);
  }
  int sign() const
  {
    for (int k = size_ - 1; k >= 0; --k)
      if (parts_[k] != 0.0) return parts_[k] > 0.0 ? 1 : -1;
    return 0;
  }

private:
  double parts_[12];
  int size_ = 0;
};

/// +1 if x lies left of the line a -> b, -1 right, never 0: x on the line is moved by (e, e^2).
int side(const Vector<2>& a, const Vector<2>& b, const Vector<2>& x)
{
  const double left = (b[0] - a[0]) * (x[1] - a[1]), right = (b[1] - a[1]) * (x[0] - a[0]);
  const double difference = left - right;
  // Seven roundings: their error is below 5e-16 of the magnitudes.
  if (std::abs(difference) > 1e-15 * (std::abs(left) + std::abs(right))) return difference > 0.0 ? 1 : -1;
  ExactSum area; // (b - a) x (x - a), multiplied out
  area.add_product(b[0], x[1]);
  area.add_product(-b[0], a[1]);
  area.add_product(-a[0], x[1]);
  area.add_product(-b[1], x[0]);
  area.add_product(b[1], a[0]);
  area.add_product(a[1], x[0]);
  if (const int sign = area.sign()) return sign;
  if (a[1] != b[1]) return a[1] > b[1] ? 1 : -1;
  return b[0] > a[0] ? 1 : -1;
}
} // namespace

bool cell_holds(const std::array<Vector<2>, 4>& corners, const std::array<Index, 4>& natural, const Vector<2>& x,
                double tolerance)
{
  // A slope no mesh edge is likely to have: along an edge the shift would not decide.
  const Vector<2> shifted = x + tolerance * Vector<2>(1.618, 1.0);
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t next = (k + 1) % 4;
    const bool forward = natural[k] < natural[next];
    const int left = forward ? side(corners[k], corners[next], shifted) : -side(corners[next], corners[k], shifted);
    if (left < 0) return false;
  }
  return true;
}

std::array<double, 4> bilinear_weights(const std::array<Vector<2>, 4>& corners, const Vector<2>& x)
{
  // x = m + a s + b t + c s t with s, t in [-1, 1]
  const Vector<2> m = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  const Vector<2> a = 0.25 * (-corners[0] + corners[1] + corners[2] - corners[3]);
  const Vector<2> b = 0.25 * (-corners[0] - corners[1] + corners[2] + corners[3]);
  const Vector<2> c = 0.25 * (corners[0] - corners[1] + corners[2] - corners[3]);
  constexpr int kMostSteps = 30;
  Vector<2> st = Vector<2>::Zero();
  for (int step = 0; step < kMostSteps; ++step) {
    Tensor<2> jacobian;
    jacobian << a + c * st[1], b + c * st[0];
    const Vector<2> change = jacobian.inverse() * (x - m - a * st[0] - b * st[1] - c * (st[0] * st[1]));
    if (!change.allFinite()) break;
    st += change;
    if (change.cwiseAbs().maxCoeff() < 1e-14) break;
  }
  const double s = st[0], t = st[1];
  return {0.25 * (1 - s) * (1 - t), 0.25 * (1 + s) * (1 - t), 0.25 * (1 + s) * (1 + t), 0.25 * (1 - s) * (1 + t)};
}
} // namespace pdx::mesh
