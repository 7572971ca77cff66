#pragma once
#include "pdx/solve/moving_system.hpp"

namespace pdx::solve {
/// Elements away from particles, which a step feels at its beginning and its end alone while all else takes several
/// steps within it: impulses [Tuckerman, Berne, Martyna, J. Chem. Phys. 97, 1992]. Each of the two forces sums to
/// nothing by itself, so momentum is kept. Elements beside particles are near: particles' fastest motion does not reach
/// beyond them, and impulses do not meet it.
class FarForces {
public:
  /// Parts the Terms of the system. Collective. @param moving must outlive it
  explicit FarForces(MovingSystem& moving);

  bool any() const { return any_; } ///< on any rank: elements that are far
  /// No step at whose ends they act is stable above it; infinite if there are none [s]. Collective.
  double limit() const;
  /// Owned rows that nothing near reaches, and all others; each ascending.
  ///@{
  std::span<const Index> rows() const { return far_; }
  std::span<const Index> near_rows() const { return near_; }
  ///@}
  /// The forces, and loads on far rows, at `moving.u`, whose halo must be fresh: the acceleration, and what is
  /// remembered for the work and where something is held.
  void evaluate(double time);
  std::span<const double> acceleration() const { return a_; } ///< of all owned components [m/s^2]
  /// Adds what they did from the last call, or `begin`, until now to the work on the system.
  void book();
  void begin(); ///< from here on `book` counts

private:
  struct Load {
    const field::Drive* drive;
    std::vector<std::size_t> entries; // of the drive, on far rows that are not held there
    std::vector<double> force, force_before, u_before;
  };
  std::vector<std::uint8_t> marked() const;
  void take_loads(const std::vector<std::uint8_t>& far);

  MovingSystem& moving_;
  bool any_ = false;
  std::vector<field::Parted*> parted_; // per Term; null: it is near as a whole
  std::vector<Index> far_, near_;
  std::vector<double> a_; // owned
  std::vector<Load> loads_;
  std::vector<double> held_, held_before_, u_before_; // per prescribed component
};
} // namespace pdx::solve
