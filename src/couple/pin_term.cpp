#include "pdx/couple/pin_term.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace pdx::couple {
Vector<2> PinMotion::at(double time) const
{
  Vector<2> now = start;
  for (Eigen::Index a = 0; a < 2; ++a)
    if (by[a] != 0.0)
      now[a] += by[a] * (moves[static_cast<std::size_t>(a)] ? history.integral(time) : history.value(time));
  return now;
}

PinTerm::PinTerm(const field::Rows& rows, std::vector<double> places, std::vector<double> half_sizes,
                 const PinRule& rule, PinMotion motion)
    : dim_(static_cast<std::size_t>(rows.dim)), places_(std::move(places)), half_sizes_(std::move(half_sizes)),
      rule_(rule), motion_(std::move(motion)), middle_(motion_.at(0.0)), noted_middle_(middle_)
{}

double PinTerm::deepest() const
{
  double deepest = std::numeric_limits<double>::lowest();
  for (std::size_t row = 0; row < half_sizes_.size(); ++row)
    if (half_sizes_[row] >= 0.0)
      deepest = std::max(deepest, rule_.radius + half_sizes_[row] -
                                      (Vector<2>(places_[dim_ * row], places_[dim_ * row + 1]) - middle_).norm());
  return deepest;
}

/// visit(row, depth [m], unit vector away from the pin)
template <class Visit> void PinTerm::for_each_touch(std::span<const double> u, Visit&& visit) const
{
  for (std::size_t row = 0; row < half_sizes_.size(); ++row) {
    const double reach = rule_.radius + half_sizes_[row];
    const Vector<2> arm =
        Vector<2>(places_[dim_ * row] + u[dim_ * row], places_[dim_ * row + 1] + u[dim_ * row + 1]) - middle_;
    if (half_sizes_[row] < 0.0 || arm.squaredNorm() >= reach * reach) continue;
    const double distance = arm.norm();
    if (distance > 0.0) visit(row, reach - distance, Vector<2>(arm / distance));
  }
}

Vector<3> PinTerm::push(std::span<const double> u) const
{
  Vector<3> sum = Vector<3>::Zero();
  for_each_touch(
      u, [&](std::size_t row, double depth, const Vector<2>& away) { sum.head<2>() += stiffness(row) * depth * away; });
  return sum;
}

void PinTerm::add_residual(std::span<const double> u, std::span<double> r) const
{
  for_each_touch(u, [&](std::size_t row, double depth, const Vector<2>& away) {
    for (std::size_t a = 0; a < 2; ++a)
      r[dim_ * row + a] -= stiffness(row) * depth * away[static_cast<Eigen::Index>(a)];
  });
}

double PinTerm::energy(std::span<const double> u) const
{
  double sum = 0.0;
  for_each_touch(u,
                 [&](std::size_t row, double depth, const Vector<2>&) { sum += 0.5 * stiffness(row) * depth * depth; });
  return sum;
}

void PinTerm::couplings(field::Couplings&, bool) const { throw std::logic_error("a pin has no tangent"); }
void PinTerm::add_jacobian(field::BlockAdder&, bool) const { throw std::logic_error("a pin has no tangent"); }

void PinTerm::add_stiffness_bound(std::span<double> blocks) const
{
  for (std::size_t row = 0; row < half_sizes_.size(); ++row)
    for (std::size_t a = 0; a < 2 && half_sizes_[row] >= 0.0; ++a)
      blocks[(row * dim_ + a) * dim_ + a] += stiffness(row);
}

void PinTerm::note(std::span<const double> u)
{
  noted_middle_ = middle_;
  noted_push_ = push(u).head<2>();
}

/// What pushes the pin on does that work on the body, by the trapezoidal rule.
double PinTerm::work_since(std::span<const double> u) const
{
  return 0.5 * (noted_push_ + push(u).head<2>()).dot(middle_ - noted_middle_);
}
} // namespace pdx::couple
