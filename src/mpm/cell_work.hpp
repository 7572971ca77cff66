#pragma once
#include "pdx/base/lanes.hpp"
#include "pdx/mpm/cell_points.hpp"

/// What cells do at their points: each has `at(h, rate, p)`, which sets the first Piola stress p if `kForces` and
/// returns a density that is summed over points if `kSums`.
namespace pdx::mpm {
template <int Dim, class T> using Gradient = law::Gradient<Dim, T>;

template <int Dim, class Law> struct ElasticForces {
  static constexpr bool kRates = false, kForces = true, kSums = false, kHourglass = true;
  Law law;
  explicit ElasticForces(const BodyMaterial& body) : law(body.elastic) {}
  template <class T> PDX_INLINE T at(const Gradient<Dim, T>& h, const Gradient<Dim, T>&, Gradient<Dim, T>& p) const
  {
    law.stress(h, p);
    return T{};
  }
};

template <int Dim, class Law> struct ElasticEnergy {
  static constexpr bool kRates = false, kForces = false, kSums = true, kHourglass = true;
  Law law;
  explicit ElasticEnergy(const BodyMaterial& body) : law(body.elastic) {}
  template <class T> PDX_INLINE T at(const Gradient<Dim, T>& h, const Gradient<Dim, T>&, Gradient<Dim, T>&) const
  {
    return law.energy(h);
  }
};

/// b rho c_L h tr(D) cof F; the density is its power.
template <int Dim> struct ViscousForces {
  static constexpr bool kRates = true, kForces = true, kSums = true, kHourglass = false;
  double factor; ///< b rho c_L h [Pa s]
  template <class T> PDX_INLINE T at(const Gradient<Dim, T>& h, const Gradient<Dim, T>& rate, Gradient<Dim, T>& p) const
  {
    Gradient<Dim, T> f;
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) f[i][j] = i == j ? 1.0 + h[i][j] : h[i][j];
    T volume;
    if constexpr (Dim == 2) {
      p[0][0] = f[1][1];
      p[1][1] = f[0][0];
      p[0][1] = -f[1][0];
      p[1][0] = -f[0][1];
      volume = f[0][0] * p[0][0] + f[0][1] * p[0][1];
    } else {
      law::cofactor(f, p);
      volume = f[0][0] * p[0][0] + f[0][1] * p[0][1] + f[0][2] * p[0][2];
    }
    T growth{};
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) growth += p[i][j] * rate[i][j];
    const T pull = factor * growth / volume;
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) p[i][j] *= pull;
    return pull * growth;
  }
};
} // namespace pdx::mpm
