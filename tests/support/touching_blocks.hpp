#pragma once
#include "support/touching.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace pdx::test {
/// Two blocks of 6 x 4 (x 4) points, the second turned by 0.3 and moved into the first.
template <int Dim> std::vector<TouchingBody<Dim>> touching_blocks()
{
  Site<Dim> first, second;
  Vector<Dim> corner = Vector<Dim>::Constant(0.7);
  first.fill(4), second.fill(4);
  first[0] = 6;
  corner[1] = 4.4;
  return {{"a", Vector<Dim>::Zero(), first, 1.0, 3.0, 1.0, true},
          {"b", corner, second, 1.0, 2.0, 1.0, false, false, Vector<Dim>::Zero(), 0.1}};
}

/// The second body moved into the first, and both dented.
template <int Dim> Vector<Dim> pressed(const typename Touching<Dim>::Row& row)
{
  Vector<Dim> u = Vector<Dim>::Zero();
  for (int d = 0; d < Dim; ++d) u[d] = 0.02 * std::sin(1.3 * row.x.sum() + d);
  if (row.body == 1) u[1] -= 0.75;
  return u;
}

struct Sums {
  std::vector<double> force, moment; // of all rows
  double size = 0.0;
};

template <int Dim>
Sums sums_of(const Touching<Dim>& scene, const std::vector<double>& force, const std::vector<double>& u)
{
  Sums sums{std::vector<double>(3, 0.0), std::vector<double>(3, 0.0), 0.0};
  for (std::size_t k = 0; k < scene.rows.size(); ++k) {
    Vector<3> x = Vector<3>::Zero(), f = Vector<3>::Zero();
    for (int d = 0; d < Dim; ++d) {
      x[d] = scene.rows[k].x[d] + u[k * Dim + static_cast<std::size_t>(d)];
      f[d] = force[k * Dim + static_cast<std::size_t>(d)];
    }
    const Vector<3> moment = x.cross(f);
    for (std::size_t d = 0; d < 3; ++d) {
      sums.force[d] += f[static_cast<Eigen::Index>(d)];
      sums.moment[d] += moment[static_cast<Eigen::Index>(d)];
    }
    sums.size += f.norm();
  }
  return sums;
}

/// Forces neither push nor turn the whole.
template <int Dim> void expect_balance(const Touching<Dim>& scene, const std::vector<double>& u)
{
  const std::vector<double> force = scene.contact_force(u);
  const Sums sums = sums_of(scene, force, scene.of_all(std::span(u).first(scene.mine.size() * Dim)));
  EXPECT_GT(sums.size, 0.05);
  for (std::size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(sums.force[d], 0.0, 1e-14 * sums.size);
    EXPECT_NEAR(sums.moment[d], 0.0, 1e-13 * sums.size);
  }
}

/// Forces are the derivatives of the energy by the displacements of rows.
template <int Dim>
void expect_derivative(Touching<Dim>& scene, const std::function<Vector<Dim>(const typename Touching<Dim>::Row&)>& u)
{
  const std::vector<double> force = scene.contact_force(scene.blocks(u));
  constexpr double kStep = 1e-6;
  for (std::size_t k = 0; k < scene.rows.size(); k += Dim == 2 ? 1 : 3)
    for (int d = 0; d < Dim; ++d) {
      const auto energy = [&](double step) {
        return scene.sum(scene.contact->energy(scene.blocks([&](const auto& row) {
          Vector<Dim> moved = u(row);
          if (&row == &scene.rows[k]) moved[d] += step;
          return moved;
        })));
      };
      EXPECT_NEAR(force[k * Dim + static_cast<std::size_t>(d)], (energy(kStep) - energy(-kStep)) / (2.0 * kStep), 1e-8);
    }
}
} // namespace pdx::test
