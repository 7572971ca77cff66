// Kernels of sites that swell against plain loops over pairs, and limits of bonds that vary from site to site.
#include "pdx/pd/breaker.hpp"
#include "window.hpp"

#include <gtest/gtest.h>

namespace {
using namespace pdx;
using law::Kinematics;
using test::at;
using test::Window;
using Rows = std::vector<double>;

void expect_close(const Rows& kernel, const Rows& reference)
{
  double largest = 0.0;
  for (const double x : reference) largest = std::max(largest, std::abs(x));
  for (std::size_t k = 0; k < kernel.size(); ++k) ASSERT_NEAR(kernel[k], reference[k], 1e-13 * largest) << k;
}

template <int Dim> void expect_sums(const Window<Dim>& w, Kinematics kinematics)
{
  const bool finite = kinematics == Kinematics::finite;
  const Rows u = w.random_vector(finite ? 0.2 * w.kDx : 0.05 * w.kDx, 1), x = w.random_vector(1.0, 2);
  const Rows half = w.random_vector(0.05, 3); // of row r: entry r
  Rows site(w.row.size(), w.kNone);
  for (Index r = 0; r < w.rows(); ++r) site[static_cast<std::size_t>(w.particles[r])] = half[r];
  Rows force(u.size()), energy(u.size() / Dim), product(u.size()), diagonal(u.size() * Dim);
  for (const auto& pair : w.pairs) {
    const Vector<Dim> eta = at<Dim>(u, pair.j) - at<Dim>(u, pair.i);
    const Vector<Dim> y = finite ? Vector<Dim>(pair.xi + eta) : pair.xi;
    const double length = pair.xi.norm(), now = y.norm();
    const double s = (finite ? now / length - 1.0 : pair.xi.dot(eta) / (length * length)) - half[pair.i] - half[pair.j];
    const Tensor<Dim> ee = y * y.transpose() / y.squaredNorm();
    const Tensor<Dim> k =
        pair.weight * pair.kappa * (ee / length + (finite ? s / now : 0.0) * (Tensor<Dim>::Identity() - ee));
    for (const auto& [i, j, sign] : {std::tuple(pair.i, pair.j, 1.0), std::tuple(pair.j, pair.i, -1.0)}) {
      at<Dim>(force, i) -= sign * pair.weight * pair.kappa * s * y / now;
      energy[i] += 0.25 * pair.weight * pair.kappa * s * s * length / w.volume();
      at<Dim>(product, i) -= k * at<Dim>(x, j);
      Eigen::Map<Tensor<Dim>>(&diagonal[i * Dim * Dim]) += k;
    }
  }
  const auto spread = w.spread(u), along = w.spread(x);
  auto view = w.view(spread);
  view.swelling = site.data();
  Rows r(u.size()), e(u.size() / Dim), y(u.size()), d(u.size() * Dim);
  pd::add_force<Dim>(view, w.runs, kinematics, r.data());
  pd::add_energy_density<Dim>(view, w.runs, kinematics, w.volume(), e.data());
  expect_close(r, force);
  expect_close(e, energy);
  if (!finite) return;
  pd::subtract_neighbours_finite<Dim>(view, w.view(along).u, w.runs, y.data());
  pd::diagonal_blocks_finite<Dim>(view, w.runs, d.data());
  expect_close(y, product);
  expect_close(d, diagonal);
}
} // namespace

TEST(Swelling, IsTakenOffTheStretchOfEachPair)
{
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite}) {
    expect_sums<2>(Window<2>({45, 15}, {.ratio = 3.015, .missing = 0.1, .broken = 0.1, .factors = true}), kinematics);
    expect_sums<3>(Window<3>({24, 8, 7}, {.ratio = 3.0, .missing = 0.1, .broken = 0.3}), kinematics);
  }
}
