// The kernels against plain loops over pairs of particles, in windows with holes, broken bonds and surface shares.
#include "window.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace {
using namespace pdx;
using law::Kinematics;
using law::Micromodulus;
using test::at;
using test::Window;
using test::WindowOptions;
using Rows = std::vector<double>;

struct Scene {
  const char* name;
  int dim;
  WindowOptions options;
};
const Scene kScenes[] = {
    {"plate", 2, {3.0}},
    {"plate with cracks", 2, {.ratio = 4.0, .broken = 0.3}},
    {"plate with holes and factors", 2, {.ratio = 3.015, .missing = 0.1, .broken = 0.1, .factors = true}},
    {"two words", 2, {6.5, Micromodulus::uniform, 0.05, 0.3, false}},
    {"solid", 3, {.ratio = 3.0, .missing = 0.1, .broken = 0.3}},
    {"two words in a solid, shares", 3, {3.015, Micromodulus::uniform, 0.05, 0.2, true}}};

/// Calls body<Dim>(window) for every scene.
template <class Body> void in_every_scene(Body body)
{
  for (const Scene& scene : kScenes) {
    SCOPED_TRACE(scene.name);
    if (scene.dim == 2)
      body(Window<2>({45, 15}, scene.options));
    else
      body(Window<3>({24, 8, 7}, scene.options));
  }
}

void expect_near(const Rows& kernel, const Rows& reference, double tolerance)
{
  ASSERT_EQ(kernel.size(), reference.size());
  double largest = 0.0, error = 0.0;
  for (std::size_t k = 0; k < kernel.size(); ++k) {
    ASSERT_TRUE(std::isfinite(kernel[k])) << k;
    largest = std::max(largest, std::abs(reference[k]));
    error = std::max(error, std::abs(kernel[k] - reference[k]));
  }
  EXPECT_LE(error, tolerance * largest);
}

/// Bond matrix [N/m] by differentiating kappa s e as printed; at rest K = kappa/|xi| n n^T.
template <int Dim> Tensor<Dim> bond_stiffness(const typename Window<Dim>::Pair& pair, const Vector<Dim>& y)
{
  const double length = pair.xi.norm(), s = y.norm() / length - 1.0;
  const Tensor<Dim> ee = y * y.transpose() / y.squaredNorm();
  return pair.weight * pair.kappa * (ee / length + s / y.norm() * (Tensor<Dim>::Identity() - ee));
}

template <int Dim> struct Reference {
  const Window<Dim>& window;
  Rows u;
  Rows force, energy, product, diagonal; ///< of the kinematics asked for
  Reference(const Window<Dim>& w, Rows displacement, const Rows& x, Kinematics kinematics)
      : window(w), u(std::move(displacement)), force(u.size()), energy(u.size() / Dim), product(u.size()),
        diagonal(u.size() * Dim)
  {
    for (const auto& pair : w.pairs) {
      const Vector<Dim> eta = at<Dim>(u, pair.j) - at<Dim>(u, pair.i);
      const bool finite = kinematics == Kinematics::finite;
      const Vector<Dim> y = finite ? Vector<Dim>(pair.xi + eta) : pair.xi;
      const double s = finite ? y.norm() / pair.xi.norm() - 1.0 : pair.xi.dot(eta) / pair.xi.squaredNorm();
      const Vector<Dim> pull = pair.weight * pair.kappa * s * y.normalized();
      const Tensor<Dim> k = bond_stiffness<Dim>(pair, y);
      for (const auto& [i, j, sign] : {std::tuple(pair.i, pair.j, 1.0), std::tuple(pair.j, pair.i, -1.0)}) {
        at<Dim>(force, i) -= sign * pull;
        energy[i] += 0.25 * pair.weight * pair.kappa * s * s * pair.xi.norm() / w.volume();
        at<Dim>(product, i) -= k * at<Dim>(x, j);
        Eigen::Map<Tensor<Dim>>(&diagonal[i * Dim * Dim]) += k;
      }
    }
  }
};

/// @param product, diagonal: the kernels for that tangent
template <int Dim, class Product, class Diagonal>
void expect_sums_over_pairs(const Window<Dim>& window, const Reference<Dim>& reference, Kinematics kinematics,
                            Product product, Diagonal diagonal)
{
  const Rows& u = reference.u;
  const auto spread = window.spread(u);
  const auto view = window.view(spread);
  Rows y(u.size()), d(u.size() * Dim), r(u.size()), w(u.size() / Dim);
  product(view, y.data());
  diagonal(view, d.data());
  pd::add_force<Dim>(view, window.runs, kinematics, r.data());
  pd::add_energy_density<Dim>(view, window.runs, kinematics, window.volume(), w.data());
  expect_near(y, reference.product, 1e-13);
  expect_near(d, reference.diagonal, 1e-13);
  expect_near(r, reference.force, 1e-13);
  expect_near(w, reference.energy, 1e-13);
}

TEST(BondKernel, LinearKernelsEqualSumsOverPairs)
{
  in_every_scene([]<int Dim>(const Window<Dim>& window) {
    const Rows u = window.random_vector(0.05 * window.kDx, 1);
    const Reference<Dim> reference(window, u, u, Kinematics::small);
    expect_sums_over_pairs<Dim>(
        window, reference, Kinematics::small,
        [&](const auto& view, double* y) { pd::subtract_neighbours<Dim>(view, window.runs, y); },
        [&](const auto& view, double* d) { pd::diagonal_blocks<Dim>(view, window.runs, d); });
  });
}

TEST(BondKernel, FiniteKernelsEqualSumsOverPairs)
{
  in_every_scene([]<int Dim>(const Window<Dim>& window) {
    const Rows u = window.random_vector(0.3 * window.kDx, 2), x = window.random_vector(1.0, 3);
    const Reference<Dim> reference(window, u, x, Kinematics::finite);
    const auto along = window.spread(x);
    expect_sums_over_pairs<Dim>(
        window, reference, Kinematics::finite,
        [&](const auto& view, double* y) {
          pd::subtract_neighbours_finite<Dim>(view, window.view(along).u, window.runs, y);
        },
        [&](const auto& view, double* d) { pd::diagonal_blocks_finite<Dim>(view, window.runs, d); });
  });
}

TEST(BondKernel, ScenesHaveBothKindsOfRuns)
{
  in_every_scene([]<int Dim>(const Window<Dim>& window) {
    std::size_t whole = 0;
    for (const pd::Run& run : window.runs) whole += run.kind == pd::RunKind::whole;
    EXPECT_GT(whole, 0u);
    EXPECT_LT(whole, window.runs.size());
  });
}

template <int Dim> void expect_run_writes_only_its_rows(const Window<Dim>& window, const pd::Run& run, const Rows& u)
{
  const auto spread = window.spread(u);
  const auto view = window.view(spread);
  const Reference<Dim> linear(window, u, u, Kinematics::small), finite(window, u, u, Kinematics::finite);
  const std::size_t first = static_cast<std::size_t>(run.row) * Dim, count = static_cast<std::size_t>(run.length) * Dim;
  const auto compare = [&](const Rows& out, const Rows& reference) {
    for (std::size_t k = 0; k < out.size(); ++k) {
      const bool mine = k >= first && k < first + count;
      const double expected = mine ? 7.0 + reference[k] : 7.0; // adds to what is there
      ASSERT_NEAR(out[k], expected, mine ? 1e-12 * (7.0 + std::abs(reference[k])) : 0.0)
          << k << " of run " << run.length;
    }
  };
  Rows out(u.size() + 64, 7.0);
  pd::subtract_neighbours<Dim>(view, {&run, 1}, out.data());
  compare(out, linear.product);
  out.assign(out.size(), 7.0);
  pd::add_force<Dim>(view, {&run, 1}, Kinematics::finite, out.data());
  compare(out, finite.force);
}

TEST(BondKernel, RunsOfAnyLengthWriteOnlyTheirRows)
{
  const Window<2> plate({50, 5}, {.ratio = 3.0});
  const Window<3> solid({46, 5, 5}, {.ratio = 2.3});
  const Rows u2 = plate.random_vector(0.1 * plate.kDx, 4), u3 = solid.random_vector(0.1 * solid.kDx, 5);
  for (Index length = 1; length <= 40; length += (length < 36 ? 1 : 2))
    for (const auto kind : {pd::RunKind::whole, pd::RunKind::partial}) {
      const Index row2 = 2 * 50 + 3, row3 = (2 * 5 + 2) * 46 + 3; // middle row, 3 sites in
      expect_run_writes_only_its_rows<2>(plate, {plate.particles[row2], row2, length, kind}, u2);
      if (length % 5 == 2) expect_run_writes_only_its_rows<3>(solid, {solid.particles[row3], row3, length, kind}, u3);
    }
}
} // namespace
