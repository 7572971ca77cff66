#include "pdx/law/cooling.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <unordered_map>

namespace pdx::law {
namespace cooling {
constexpr double kEarly = 5e-3; // Fourier number below which the far face knows nothing: erfc(1 / (2 sqrt(Fo))) < 2e-23
constexpr int kRoots = 40;      // at kEarly the last is exp(-75)
constexpr double kLarge = 25.0; // exp(z^2) is a number below

/// exp(z^2) erfc(z) for z >= 0.
double scaled_erfc(double z)
{
  if (z < kLarge) return std::exp(z * z) * std::erfc(z);
  const double q = 1.0 / (2.0 * z * z); // asymptotic, the next term is below 1e-13
  return std::numbers::inv_sqrtpi / z * (1.0 - q * (1.0 - 3.0 * q * (1.0 - 5.0 * q * (1.0 - 7.0 * q))));
}

/// The root of z sin z = Bi cos z between n pi and (n + 1/2) pi, by halves.
double wall_root(int n, double biot)
{
  double low = n * std::numbers::pi, high = (n + 0.5) * std::numbers::pi;
  if (std::isinf(biot)) return high;
  const double sign = n % 2 ? -1.0 : 1.0;
  for (;;) {
    const double z = 0.5 * (low + high);
    if (z <= low || z >= high) return z;
    (sign * (z * std::sin(z) - biot * std::cos(z)) > 0.0 ? high : low) = z;
  }
}
} // namespace cooling

CooledWall::CooledWall(double biot) : biot_(biot)
{
  using namespace cooling;
  for (int n = 0; n < kRoots; ++n) roots_.push_back(wall_root(n, biot));
}

double CooledWall::in_half_space(double depth, double fourier) const
{
  if (fourier <= 0.0) return 1.0;
  const double g = depth / (2.0 * std::sqrt(fourier));
  if (std::isinf(biot_)) return std::erf(g);
  return std::erf(g) + std::exp(-g * g) * cooling::scaled_erfc(g + biot_ * std::sqrt(fourier));
}

double CooledWall::share(double depth, double fourier) const
{
  if (fourier < cooling::kEarly) return in_half_space(depth, fourier);
  double sum = 0.0;
  for (const double z : roots_) {
    const double decay = std::exp(-z * z * fourier);
    if (decay < 1e-30) break;
    sum += 4.0 * std::sin(z) / (2.0 * z + std::sin(2.0 * z)) * std::cos(z * (1.0 - depth)) * decay;
  }
  return sum;
}

Cooling::Cooling(const Data& data) : diffusivity_(data.diffusivity)
{
  for (Eigen::Index d = 0; d < 2; ++d) {
    const auto side = static_cast<std::size_t>(2 * d);
    const bool lower = data.cooled[side], upper = data.cooled[side + 1];
    if (!lower && !upper) continue;
    const double width = data.body.size()[d] * (lower && upper ? 0.5 : 1.0);
    directions_[static_cast<std::size_t>(d)] = Direction{data.body.lower[d],
                                                         data.body.upper[d],
                                                         width,
                                                         lower,
                                                         upper,
                                                         CooledWall(data.transfer * width / data.conductivity)};
  }
}

double Cooling::Direction::share(double x, double diffusivity, double time) const
{
  const double below = from_lower ? x - lower : upper - x, above = from_upper ? upper - x : x - lower;
  const double depth = std::clamp(std::min(below, above) / width, 0.0, 1.0);
  return wall.share(depth, diffusivity * time / (width * width));
}

std::function<double(const Vector<2>&)> Cooling::share(double time) const
{
  using Lines = std::array<std::unordered_map<double, double>, 2>;
  return [this, time, lines = std::make_shared<Lines>()](const Vector<2>& x) {
    double product = 1.0;
    for (std::size_t d = 0; d < 2; ++d) {
      if (!directions_[d]) continue;
      const double along = x[static_cast<Eigen::Index>(d)];
      const auto [at, is_new] = (*lines)[d].try_emplace(along, 0.0);
      if (is_new) at->second = directions_[d]->share(along, diffusivity_, time);
      product *= at->second;
    }
    return product;
  };
}
} // namespace pdx::law
