#pragma once
#include "pdx/field/history.hpp"
#include "pdx/field/support.hpp"

#include <array>

namespace pdx::couple {
/// Where a pin is as time goes: each coordinate by a history of displacements, or of velocities. In statics by a
/// displacement that grows with the load.
struct PinMotion {
  Vector<2> start = Vector<2>::Zero(); ///< [m]
  Vector<2> by = Vector<2>::Zero();    ///< [m] or [m/s]
  field::History history;
  std::array<bool, 2> moves{}; ///< `by` is a velocity
  bool in_time = true;

  Vector<2> at(double time) const;
  Vector<2> at_load(double load) const { return start + load * by; }
  Vector<2> first() const { return in_time ? at(0.0) : start; }
};

struct PinRule {
  double radius = 0.0;    ///< [m]
  double modulus = 0.0;   ///< of the layer between pin and body [Pa]
  double thickness = 0.0; ///< of a body in the plane; 0: in space [m]
};

/// A rigid round pin, in space a cylinder along z: rows nearer to its middle than R + s, s how far the body goes beyond
/// the row's place, are pushed away by k (R + s - d), without friction; k = E t in the plane and 2 E s in space, as
/// `ContactLaw` has it of two lone points of one size. Its tangent is that of what touches, of what lies just at it
/// too: that will push if it comes nearer.
class PinTerm final : public field::Support {
public:
  static constexpr double kTouching = 1e-6; ///< of the radius: what is as near lies at the pin

  /// @param places of owned rows, dim each [m]   @param half_sizes s of each; below 0: the row is none that touches
  PinTerm(const field::Rows& rows, std::vector<double> places, std::vector<double> half_sizes, const PinRule& rule,
          PinMotion motion);

  double deepest() const; ///< by which any row is in the pin at the start, below 0 where none is [m]
  Vector<2> middle() const { return middle_; }

  Vector<3> push(std::span<const double> u) const override;
  void add_residual(std::span<const double> u, std::span<double> r) const override;
  double energy(std::span<const double> u) const override;
  void linearise(std::span<const double> u) override { linearised_.assign(u.begin(), u.end()); }
  void couplings(field::Couplings& couplings, bool whole) const override { (void)couplings, (void)whole; }
  void add_jacobian(field::BlockAdder& adder, bool whole) const override;
  void resisting(std::vector<field::Resisting>& found) const override;
  void add_stiffness_bound(std::span<double> blocks) const override;
  void go_to_time(double time) override { middle_ = motion_.at(time); }
  void go_to_load(double load) override { middle_ = motion_.at_load(load); }
  void note(std::span<const double> u) override;
  double work_since(std::span<const double> u) const override;

private:
  template <class Visit> void for_each_near(std::span<const double> u, double gap, Visit&& visit) const;
  template <class Visit> void for_each_touch(std::span<const double> u, Visit&& visit) const
  {
    for_each_near(u, 0.0, visit);
  }
  double stiffness(std::size_t row) const
  {
    return rule_.modulus * (rule_.thickness > 0.0 ? rule_.thickness : 2.0 * half_sizes_[row]);
  }

  std::size_t dim_;
  std::vector<double> places_, half_sizes_;
  PinRule rule_;
  PinMotion motion_;
  std::vector<double> linearised_; // displacement of the tangent [m]
  Vector<2> middle_, noted_middle_;
  Vector<2> noted_push_ = Vector<2>::Zero(); // [N]
};
} // namespace pdx::couple
