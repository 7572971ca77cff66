#pragma once
#include "pdx/base/lanes.hpp"
#include "pdx/base/tensor.hpp"
#include "pdx/law/elastic.hpp"

#include <utility>

/// Hyperelastic laws of the displacement gradient H = F - I in the reference: first Piola stress P = d psi / d F,
/// energy density psi, tangent d P / d F and the speed of waves. H, not F, is what they take: what is small is not lost
/// in the rounding of 1. T is a double, or lanes of them. Values per volume of the reference; not yet times the
/// thickness.
namespace pdx::law {
/// Dim x Dim numbers, of which lanes may be many: H(i, J) = d u_i / d X_J.
template <int Dim, class T> using Gradient = T[Dim][Dim];
/// d P_iJ / d F_kL at (i * Dim + J, k * Dim + L); symmetric.
template <int Dim> using Tangent = Eigen::Matrix<double, Dim * Dim, Dim * Dim>;

/// First Lame parameter of the solid itself: E nu / ((1 + nu)(1 - 2 nu)), not that of plane stress. [Pa]
inline double solid_lambda(const Elastic& elastic)
{
  return elastic.young * elastic.poisson / ((1.0 + elastic.poisson) * (1.0 - 2.0 * elastic.poisson));
}

/// What a polar decomposition F = R U tells: `lack` = I - R and `growth` = tr U - Dim, both to rounding of H.
///@{
/// In the plane (cos, sin) of R are (F11 + F22, F21 - F12) / tr U.
template <class T> PDX_INLINE void rotate(const Gradient<2, T>& h, Gradient<2, T>& lack, T& growth)
{
  const T trace = h[0][0] + h[1][1], turn = 0.5 * (h[1][0] - h[0][1]);
  const T excess = trace + (0.25 * trace * trace + turn * turn); // (tr U / 2)^2 - 1
  const T both = 1.0 + excess;
  const T shortened = excess / (both + root(both)); // 1 - 2 / tr U
  growth = 2.0 * (excess - both * shortened);
  lack[0][0] = lack[1][1] = shortened - 0.5 * trace * (1.0 - shortened);
  lack[0][1] = turn - turn * shortened;
  lack[1][0] = -lack[0][1];
}

template <class T> PDX_INLINE void cofactor(const Gradient<3, T>& a, Gradient<3, T>& cof)
{
  PDX_UNROLL
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    PDX_UNROLL
    for (int m = 0; m < 3; ++m) {
      const int n = (m + 1) % 3, o = (m + 2) % 3;
      cof[i][m] = a[j][n] * a[k][o] - a[j][o] * a[k][n];
    }
  }
}

/// Of the square of a last step of Newton's: what is left is of the order of the square of that.
inline constexpr double kNewton = 1e-16;

/// In space y = tr U is the largest root of y^4 - 2 I y^2 - 8 J y + I^2 - 4 II = 0, I and II invariants of C = F^T F,
/// J = det F: the quartic of best rotations (Shuster and Oh, QUEST, 1981). Newton from sqrt(3 I) >= y falls onto it.
/// Its derivative by F is R = ((y^2 + I) F + 2 y cof F - 2 F C) / (y (y^2 - I) - 2 J). Here y = 3 + growth, C = I + S,
/// and what cancels for small H is left out by hand.
template <class T> PDX_INLINE void rotate(const Gradient<3, T>& h, Gradient<3, T>& lack, T& growth)
{
  Gradient<3, T> s, cof;
  PDX_UNROLL
  for (int a = 0; a < 3; ++a)
    for (int b = a; b < 3; ++b)
      s[a][b] = s[b][a] = h[a][b] + h[b][a] + h[0][a] * h[0][b] + h[1][a] * h[1][b] + h[2][a] * h[2][b];
  cofactor(h, cof);
  const T trace = h[0][0] + h[1][1] + h[2][2];
  const T grown = trace + (cof[0][0] + cof[1][1] + cof[2][2]) +
                  (h[0][0] * cof[0][0] + h[0][1] * cof[0][1] + h[0][2] * cof[0][2]); // J - 1
  const T first = s[0][0] + s[1][1] + s[2][2];
  const T second = s[0][0] * s[1][1] + s[1][1] * s[2][2] + s[2][2] * s[0][0] -
                   (s[0][1] * s[0][1] + s[1][2] * s[1][2] + s[2][0] * s[2][0]);
  const T c0 = first * (first - 20.0) - 24.0 * grown - 4.0 * second, c1 = 64.0 - 12.0 * first - 8.0 * grown,
          c2 = 48.0 - 2.0 * first;
  const T guess = c0 * (-1.0 / 64.0), off = 1.0 - c1 * (1.0 / 64.0), bend = c2 * (-1.0 / 64.0);
  T x = guess + (off + bend * guess) * guess; // to second order of the strain, then to third
  x = guess + (off + (bend - 0.1875 * x) * x) * x;
  T per_slope, step;
  const auto fall = [&]() __attribute__((always_inline))
  {
    per_slope = 1.0 / (((4.0 * x + 36.0) * x + 2.0 * c2) * x + c1);
    step = ((((x + 12.0) * x + c2) * x + c1) * x + c0) * per_slope;
    x -= step;
  };
  fall();
  auto going = (step * step <= kNewton) == 0; // not a number either; each lane stops by itself, whoever is beside it
  if (any_true(going)) {
    x = going ? first / (3.0 + root(9.0 + 3.0 * first)) * 3.0 : x;
    int turns = 0;
    do {
      const T there = x, last = step, slope = per_slope;
      fall();
      x = going ? x : there;
      step = going ? step : last;
      per_slope = going ? per_slope : slope;
      going &= step * step > kNewton;
    } while (++turns < 60 && any_true(going));
  }
  growth = x;
  const T first_factor = 10.0 + (6.0 + x) * x + first, second_factor = 6.0 + 2.0 * x;
  const T on_diagonal =
      (4.0 + x) * first - ((x + 8.0) * x + 16.0) * x + second_factor * trace + 2.0 * grown; // small as H is
  // y (y^2 - I) - 2 J is a quarter of the slope, here that of the last step moved along.
  const T per = -4.0 * per_slope * (1.0 + step * per_slope * ((12.0 * x + 72.0) * x + 2.0 * c2));
  PDX_UNROLL
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      T sum = first_factor * h[i][j] + second_factor * (cof[i][j] - h[j][i]) -
              2.0 * (s[i][j] + h[i][0] * s[0][j] + h[i][1] * s[1][j] + h[i][2] * s[2][j]);
      if (i == j) sum += on_diagonal;
      lack[i][j] = sum * per;
    }
}
///@}

/// Linear in the Biot strain U - I: psi = mu |U - I|^2 + lambda/2 tr(U - I)^2, P = R (lambda tr(U - I) I + 2 mu (U -
/// I)).
template <int Dim> struct Corotational {
  double lambda, mu, density; ///< lambda of the plane problem [Pa], [Pa], [kg/m^3]

  explicit Corotational(const Elastic& elastic)
      : lambda(Dim == 2 ? elastic.lambda() : solid_lambda(elastic)), mu(elastic.mu()), density(elastic.density)
  {}
  template <class T> PDX_INLINE void stress(const Gradient<Dim, T>& h, Gradient<Dim, T>& p) const
  {
    Gradient<Dim, T> lack;
    T growth;
    rotate(h, lack, growth);
    const T pressure = lambda * growth, rest = 2.0 * mu - pressure;
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        p[i][j] = 2.0 * mu * h[i][j] + rest * lack[i][j];
        if (i == j) p[i][j] += pressure;
      }
  }
  template <class T> PDX_INLINE T energy(const Gradient<Dim, T>& h) const
  {
    Gradient<Dim, T> lack;
    T growth, square{};
    rotate(h, lack, growth);
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) square += (h[i][j] + lack[i][j]) * (h[i][j] + lack[i][j]);
    return mu * square + 0.5 * lambda * growth * growth;
  }
  Tangent<Dim> tangent(const Tensor<Dim>& h) const;
  /// Of the fastest plane wave in any direction, in lengths of the reference; `density` must be positive. [m/s]
  double wave_speed(const Tensor<Dim>& h) const;
};

/// psi = mu/2 (tr C - 3 - 2 ln J) + lambda/2 (ln J)^2 of the solid [Bonet and Wood, Nonlinear continuum mechanics,
/// 2nd ed., Eq. 6.28]. In plane stress the stretch sqrt(1 + w) out of the plane makes P_33 = 0:
/// mu w + lambda ln J = 0. F turned inside out gives not-a-number.
template <int Dim> struct NeoHooke {
  double lambda, mu, density; ///< lambda of the solid [Pa], [Pa], [kg/m^3]
  bool plane_stress;

  explicit NeoHooke(const Elastic& elastic)
      : lambda(solid_lambda(elastic)), mu(elastic.mu()), density(elastic.density),
        plane_stress(Dim == 2 && elastic.plane == Plane::stress)
  {}
  template <class T> PDX_INLINE void stress(const Gradient<Dim, T>& h, Gradient<Dim, T>& p) const
  {
    Gradient<Dim, T> cof;
    T grown, higher;
    volume(h, cof, grown, higher);
    const T spherical = plane_stress ? -mu * thickening(grown - log_shortfall(grown), grown)
                                     : lambda * (grown - log_shortfall(grown)); // lambda ln J
    const T per = 1.0 / (1.0 + grown);
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        T sum = (spherical - mu) * cof[i][j];
        if (i == j) sum += spherical + mu * grown;
        p[i][j] = mu * h[i][j] + sum * per;
      }
  }
  template <class T> PDX_INLINE T energy(const Gradient<Dim, T>& h) const
  {
    Gradient<Dim, T> cof;
    T grown, higher, square{};
    volume(h, cof, grown, higher);
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) square += h[i][j] * h[i][j];
    T rest = log_shortfall(grown), log = grown - rest;
    if (plane_stress) {
      const T w = thickening(log, grown), short_w = log_shortfall(w);
      rest += 0.5 * short_w;
      log += 0.5 * (w - short_w);
    }
    return mu * (0.5 * square + rest - higher) + 0.5 * lambda * log * log;
  }
  Tangent<Dim> tangent(const Tensor<Dim>& h) const;
  /// Of the fastest plane wave in any direction, in lengths of the reference; `density` must be positive. [m/s]
  double wave_speed(const Tensor<Dim>& h) const;

private:
  std::pair<double, double> pull(const Tensor<Dim>& h) const;
  /// cof F - I, det F - 1, and the latter without its part tr H of first order.
  template <class T>
  static PDX_INLINE void volume(const Gradient<Dim, T>& h, Gradient<Dim, T>& cof, T& grown, T& higher)
  {
    if constexpr (Dim == 2) {
      cof[0][0] = h[1][1];
      cof[1][1] = h[0][0];
      cof[0][1] = -h[1][0];
      cof[1][0] = -h[0][1];
      higher = h[0][0] * h[1][1] - h[0][1] * h[1][0];
      grown = h[0][0] + h[1][1] + higher;
    } else {
      cofactor(h, cof);
      const T trace = h[0][0] + h[1][1] + h[2][2];
      higher = cof[0][0] + cof[1][1] + cof[2][2] + (h[0][0] * cof[0][0] + h[0][1] * cof[0][1] + h[0][2] * cof[0][2]);
      grown = trace + higher;
      PDX_UNROLL
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          cof[i][j] -= h[j][i];
          if (i == j) cof[i][j] += trace;
        }
    }
  }
  /// w of plane stress by Newton, where strains are large from below: the function is concave. @param log of 1 + grown,
  /// in the plane
  template <class T> PDX_INLINE T thickening(T log, T grown) const
  {
    const double part = lambda / (2.0 * mu + lambda);
    const T from = -2.0 * part * log; // w = from + part (w - ln(1 + w))
    T w = from + 0.5 * part * from * from, step;
    w = from + part * (0.5 - (1.0 / 3.0) * w) * (w * w); // to third order of the strain
    const auto rise = [&]() __attribute__((always_inline))
    {
      step = (w - from - part * log_shortfall(w)) / (1.0 - part * w / (1.0 + w));
      w -= step;
    };
    rise();
    auto going = (step * step <= kNewton) == 0; // as in `rotate`
    if (any_true(going)) {
      const T stretch = 1.0 + grown, least = 1.0 / (stretch * stretch) - 1.0,
              start = log > 0.0 && least > from ? least : from;
      w = going ? start : w;
      int turns = 0;
      do {
        const T there = w;
        rise();
        w = going ? w : there;
        going &= step * step > kNewton;
      } while (++turns < 60 && any_true(going));
    }
    return w;
  }
};
} // namespace pdx::law
