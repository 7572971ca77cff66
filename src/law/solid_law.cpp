#include "pdx/law/solid_law.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace pdx::law {
namespace {
template <int Dim> using Flat = Eigen::Matrix<double, Dim * Dim, 1>;

/// (i, J) at i * Dim + J.
template <int Dim> Flat<Dim> flat(const Tensor<Dim>& a)
{
  Flat<Dim> v;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) v[i * Dim + j] = a(i, j);
  return v;
}

template <int Dim> struct Polar {
  Tensor<Dim> rotation, stretch;
  double growth = 0.0; ///< tr U - Dim

  explicit Polar(const Tensor<Dim>& h)
  {
    double from[Dim][Dim], lack[Dim][Dim];
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) from[i][j] = h(i, j);
    rotate(from, lack, growth);
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) rotation(i, j) = (i == j) - lack[i][j];
    const Tensor<Dim> u = rotation.transpose() * (Tensor<Dim>::Identity() + h);
    stretch = 0.5 * (u + u.transpose());
  }
};

double largest_root(const Tensor<2>& a) { return 0.5 * (a.trace() + std::hypot(a(0, 0) - a(1, 1), 2.0 * a(0, 1))); }
/// Largest eigenvalue of a symmetric matrix, by the cosine of a third of an angle.
double largest_root(const Tensor<3>& a)
{
  const double mean = a.trace() / 3.0;
  const Tensor<3> rest = a - mean * Tensor<3>::Identity();
  const double size = std::sqrt(rest.squaredNorm() / 6.0);
  if (size == 0.0) return mean;
  const double angle = std::acos(std::clamp(0.5 * rest.determinant() / (size * size * size), -1.0, 1.0));
  return mean + 2.0 * size * std::cos(angle / 3.0);
}

/// The turns that R resists: d R = sum of turns x (inverse of the matrix behind it) x turns.
Eigen::Matrix<double, 4, 1> turns(const Tensor<2>& r)
{
  Tensor<2> turn;
  turn << 0.0, -1.0, 1.0, 0.0;
  return flat<2>(r * turn);
}
Eigen::Matrix<double, 9, 3> turns(const Tensor<3>& r)
{
  Eigen::Matrix<double, 9, 3> all;
  for (int axis = 0; axis < 3; ++axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    Tensor<3> turn = Tensor<3>::Zero();
    turn(k, j) = 1.0;
    turn(j, k) = -1.0;
    all.col(axis) = flat<3>(r * turn);
  }
  return all;
}
Eigen::Matrix<double, 1, 1> turning(const Tensor<2>& stretch) { return Eigen::Matrix<double, 1, 1>(stretch.trace()); }
Tensor<3> turning(const Tensor<3>& stretch) { return stretch.trace() * Tensor<3>::Identity() - stretch; }
} // namespace

/// d P = 2 mu d F + lambda R (R : d F) + (lambda tr(U - I) - 2 mu) d R; d R = R [omega x] with
/// (tr U I - U) omega = axial vector of R^T d F.
template <int Dim> Tangent<Dim> Corotational<Dim>::tangent(const Tensor<Dim>& h) const
{
  const Polar<Dim> polar(h);
  const Flat<Dim> r = flat<Dim>(polar.rotation);
  const auto t = turns(polar.rotation);
  const double rest = lambda * polar.growth - 2.0 * mu;
  return 2.0 * mu * Tangent<Dim>::Identity() + lambda * r * r.transpose() +
         rest * t * turning(polar.stretch).inverse() * t.transpose();
}

/// a n : d P / d F : a n = 2 mu + lambda (a.R n)^2 + (lambda tr(U - I) - 2 mu) v.(tr U I - U)^-1 v, v = R^T a x n: the
/// last is negative unless the body has grown by more than 2 mu / lambda.
template <int Dim> double Corotational<Dim>::wave_speed(const Tensor<Dim>& h) const
{
  const Polar<Dim> polar(h);
  const double rest = lambda * polar.growth - 2.0 * mu;
  const double slack = polar.growth + Dim - (Dim == 2 ? 0.0 : largest_root(polar.stretch));
  return std::sqrt((2.0 * mu + std::max(lambda, rest / slack)) / density);
}

/// d P = mu d F + (mu - lambda ln J) F^-T d F^T F^-T + lambda' F^-T (F^-T : d F), in plane stress with
/// lambda' = 2 mu lambda (1 + w) / (2 mu (1 + w) + lambda).
template <int Dim> Tangent<Dim> NeoHooke<Dim>::tangent(const Tensor<Dim>& h) const
{
  const Tensor<Dim> inverse = (Tensor<Dim>::Identity() + h).inverse();
  const auto [spherical, lambda_now] = pull(h);
  const Flat<Dim> direction = flat<Dim>(inverse.transpose());
  Tangent<Dim> a = mu * Tangent<Dim>::Identity() + lambda_now * direction * direction.transpose();
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < Dim; ++k)
        for (int l = 0; l < Dim; ++l) a(i * Dim + j, k * Dim + l) += (mu - spherical) * inverse(l, i) * inverse(j, k);
  return a;
}

/// a n : d P / d F : a n = mu + (mu - lambda ln J + lambda') (a.F^-T n)^2.
template <int Dim> double NeoHooke<Dim>::wave_speed(const Tensor<Dim>& h) const
{
  const Tensor<Dim> inverse = (Tensor<Dim>::Identity() + h).inverse();
  const auto [spherical, lambda_now] = pull(h);
  const double longest = largest_root(Tensor<Dim>(inverse * inverse.transpose()));
  return std::sqrt((mu + std::max(0.0, mu - spherical + lambda_now) * longest) / density);
}

/// lambda ln J, and lambda' of the tangent.
template <int Dim> std::pair<double, double> NeoHooke<Dim>::pull(const Tensor<Dim>& h) const
{
  double from[Dim][Dim], cof[Dim][Dim], grown = 0.0, higher = 0.0;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) from[i][j] = h(i, j);
  volume(from, cof, grown, higher);
  const double log = grown - log_shortfall(grown);
  if (!plane_stress) return {lambda * log, lambda};
  const double w = thickening(log, grown);
  return {-mu * w, 2.0 * mu * lambda * (1.0 + w) / (2.0 * mu * (1.0 + w) + lambda)};
}

template struct Corotational<2>;
template struct Corotational<3>;
template struct NeoHooke<2>;
template struct NeoHooke<3>;
} // namespace pdx::law
