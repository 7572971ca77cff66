#pragma once
#include "pdx/base/tensor.hpp"

#include <cmath>

namespace pdx::law {
/// Stretch and direction of one bond with reference vector xi [m] and relative displacement eta [m].
template <int Dim> struct BondState {
  double stretch;        ///< s [-]
  Vector<Dim> direction; ///< unit vector the force acts along
  double transverse;     ///< s |xi| / |xi + eta| for finite stretch, 0 for linear: weight of the geometric stiffness
};

/// Finite stretch without cancellation: s = (2 xi.eta + eta.eta) / (|xi| (|xi+eta| + |xi|)), along xi + eta.
/// @param free strain of the bond that bears nothing; s is what is beyond it [-]
template <int Dim>
BondState<Dim> finite_state(const Vector<Dim>& xi, double length, const Vector<Dim>& eta, double free = 0.0)
{
  const Vector<Dim> y = xi + eta;
  const double deformed = y.norm();
  const double s = (2.0 * xi.dot(eta) + eta.squaredNorm()) / (length * (deformed + length)) - free;
  return {s, y / deformed, s * length / deformed};
}

/// Linearised stretch: s = xi.eta / |xi|^2, along xi. @param free as above
template <int Dim>
BondState<Dim> linear_state(const Vector<Dim>& xi, double length, const Vector<Dim>& eta, double free = 0.0)
{
  return {xi.dot(eta) / (length * length) - free, xi / length, 0.0};
}

/// Tangent of the bond force kappa s e with respect to eta [N/m]: kappa/|xi| (e e^T + t (I - e e^T)).
template <int Dim> Tensor<Dim> bond_stiffness(double kappa, double length, const BondState<Dim>& state)
{
  const Tensor<Dim> along = state.direction * state.direction.transpose();
  return kappa / length * (along + state.transverse * (Tensor<Dim>::Identity() - along));
}

/// Energy of one bond, 1/2 kappa s^2 |xi| [J].
inline double bond_energy(double kappa, double length, double stretch)
{
  return 0.5 * kappa * stretch * stretch * length;
}
} // namespace pdx::law
