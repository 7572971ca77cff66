// Rates of the bond kernels on 200 x 200 particles, conical m = 4, all bonds there, one core; items are directed bonds.
#include "pdx/geom/lattice.hpp"
#include "pdx/pd/bond_kernel.hpp"
#include "pdx/pd/stencil.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <vector>

namespace {
using namespace pdx;
constexpr int kSide = 200;

/// A square of particles inside a frame of `reach` fixed sites.
struct Square {
  pd::Stencil<2> stencil;
  std::ptrdiff_t stride = 0;
  std::array<std::vector<double>, 2> u;
  std::array<std::vector<std::uint64_t>, 2> words;
  std::vector<pd::HalfArm<2>> arms;
  std::vector<pd::Run> runs;
  std::vector<double> y;

  Square(pd::RunKind kind, law::Micromodulus micromodulus)
  {
    const law::Elastic elastic{.young = 192e9, .poisson = 1.0 / 3.0};
    stencil = pd::make_stencil<2>({.dx = 1e-3, .horizon = 4e-3, .micromodulus = micromodulus, .elastic = elastic});
    stride = kSide + 2 * stencil.reach + 16;
    const std::size_t size = static_cast<std::size_t>(stride * (kSide + 2 * stencil.reach + 1));
    for (std::size_t d = 0; d < 2; ++d) {
      u[d].resize(size);
      for (std::size_t i = 0; i < size; ++i) u[d][i] = 1e-6 * std::sin(0.1 * static_cast<double>(i) + double(d));
      words[d].assign(size, ~std::uint64_t{0});
    }
    for (const auto& arm : stencil.half)
      arms.push_back({arm.step[1] * stride + arm.step[0], {arm.xi[0], arm.xi[1]}, arm.length, arm.kappa});
    for (Index j = 0; j < kSide; ++j)
      runs.push_back({(j + stencil.reach) * stride + stencil.reach, j * kSide, kSide, kind});
    y.assign(4 * kSide * kSide, 0.0);
  }
  pd::BondView<2> view() const
  {
    return {{u[0].data(), u[1].data()}, {words[0].data(), words[1].data()}, nullptr, nullptr, arms};
  }
  std::int64_t bonds() const { return std::int64_t{2} * kSide * kSide * static_cast<std::int64_t>(arms.size()); }
};

template <class Kernel> void measure(benchmark::State& state, pd::RunKind kind, Kernel kernel)
{
  Square square(kind, law::Micromodulus::conical);
  const pd::BondView<2> view = square.view();
  for ([[maybe_unused]] auto _ : state) {
    kernel(view, square);
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * square.bonds());
}

void subtract_neighbours(benchmark::State& state, pd::RunKind kind)
{
  measure(state, kind, [](const auto& view, Square& s) { pd::subtract_neighbours<2>(view, s.runs, s.y.data()); });
}
void diagonal_blocks(benchmark::State& state, pd::RunKind kind)
{
  measure(state, kind, [](const auto& view, Square& s) { pd::diagonal_blocks<2>(view, s.runs, s.y.data()); });
}
void add_force(benchmark::State& state, pd::RunKind kind, law::Kinematics kinematics)
{
  measure(state, kind,
          [kinematics](const auto& view, Square& s) { pd::add_force<2>(view, s.runs, kinematics, s.y.data()); });
}
void subtract_neighbours_finite(benchmark::State& state, pd::RunKind kind)
{
  measure(state, kind,
          [](const auto& view, Square& s) { pd::subtract_neighbours_finite<2>(view, view.u, s.runs, s.y.data()); });
}
void diagonal_blocks_finite(benchmark::State& state, pd::RunKind kind)
{
  measure(state, kind, [](const auto& view, Square& s) { pd::diagonal_blocks_finite<2>(view, s.runs, s.y.data()); });
}

/// The same product as subtract_neighbours from a neighbour list, each bond's matrix stored: the usual way.
void neighbour_list(benchmark::State& state)
{
  struct Bond {
    std::int32_t j;
    double xx, xy, yy;
  };
  Square square(pd::RunKind::whole, law::Micromodulus::conical);
  std::vector<Bond> bonds;
  std::vector<std::size_t> first{0};
  for (const pd::Run& run : square.runs)
    for (Index k = 0; k < run.length; ++k) {
      for (const auto& arm : square.arms) {
        const double c = arm.kappa / std::pow(arm.length, 3);
        for (const int sign : {1, -1})
          bonds.push_back({static_cast<std::int32_t>(run.at + k + sign * arm.jump), c * arm.xi[0] * arm.xi[0],
                           c * arm.xi[0] * arm.xi[1], c * arm.xi[1] * arm.xi[1]});
      }
      first.push_back(bonds.size());
    }
  const double *ux = square.u[0].data(), *uy = square.u[1].data();
  for ([[maybe_unused]] auto _ : state) {
    for (std::size_t row = 0; row + 1 < first.size(); ++row) {
      double fx = 0.0, fy = 0.0;
      for (std::size_t b = first[row]; b < first[row + 1]; ++b) {
        const Bond& bond = bonds[b];
        fx += bond.xx * ux[bond.j] + bond.xy * uy[bond.j];
        fy += bond.xy * ux[bond.j] + bond.yy * uy[bond.j];
      }
      square.y[2 * row] -= fx;
      square.y[2 * row + 1] -= fy;
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * square.bonds());
}

BENCHMARK_CAPTURE(subtract_neighbours, whole, pd::RunKind::whole);
BENCHMARK_CAPTURE(subtract_neighbours, partial, pd::RunKind::partial);
BENCHMARK(neighbour_list);
BENCHMARK_CAPTURE(diagonal_blocks, whole, pd::RunKind::whole);
BENCHMARK_CAPTURE(add_force, whole_linear, pd::RunKind::whole, law::Kinematics::small);
BENCHMARK_CAPTURE(add_force, whole_finite, pd::RunKind::whole, law::Kinematics::finite);
BENCHMARK_CAPTURE(add_force, partial_finite, pd::RunKind::partial, law::Kinematics::finite);
BENCHMARK_CAPTURE(subtract_neighbours_finite, whole, pd::RunKind::whole);
BENCHMARK_CAPTURE(subtract_neighbours_finite, partial, pd::RunKind::partial);
BENCHMARK_CAPTURE(diagonal_blocks_finite, whole, pd::RunKind::whole);
} // namespace

BENCHMARK_MAIN();
