#include "pdx/couple/pin_term.hpp"

#include <algorithm>
#include <limits>

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
      rule_(rule), motion_(std::move(motion)), linearised_(places_.size(), 0.0), middle_(motion_.first()),
      noted_middle_(middle_)
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

/// visit(row, depth [m], unit vector away from the pin) where the depth is above -gap
template <class Visit> void PinTerm::for_each_near(std::span<const double> u, double gap, Visit&& visit) const
{
  for (std::size_t row = 0; row < half_sizes_.size(); ++row) {
    const double reach = rule_.radius + half_sizes_[row] + gap;
    const Vector<2> arm =
        Vector<2>(places_[dim_ * row] + u[dim_ * row], places_[dim_ * row + 1] + u[dim_ * row + 1]) - middle_;
    if (half_sizes_[row] < 0.0 || arm.squaredNorm() >= reach * reach) continue;
    const double distance = arm.norm();
    if (distance > 0.0) visit(row, reach - gap - distance, Vector<2>(arm / distance));
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

/// k n n where it touches, less what the force k depth n loses as n turns.
void PinTerm::add_jacobian(field::BlockAdder& adder, bool) const
{
  for_each_near(linearised_, kTouching * rule_.radius, [&](std::size_t row, double depth, const Vector<2>& away) {
    const auto local = static_cast<Index>(row);
    const double k = stiffness(row), pressed = std::max(depth, 0.0), distance = rule_.radius + half_sizes_[row] - depth;
    const Eigen::Matrix2d along = away * away.transpose();
    const Eigen::Matrix2d block = k * (along - pressed / distance * (Eigen::Matrix2d::Identity() - along));
    std::vector<double> panel(dim_ * dim_, 0.0);
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 0; b < 2; ++b)
        panel[a * dim_ + b] = block(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
    adder.add(std::span(&local, 1), std::span(&local, 1), panel);
  });
}

void PinTerm::resisting(std::vector<field::Resisting>& found) const
{
  for_each_near(linearised_, kTouching * rule_.radius, [&](std::size_t row, double, const Vector<2>& away) {
    found.push_back({static_cast<Index>(row), {away[0], away[1], 0.0}});
  });
}

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
