// What an explicit step of material points on a kept grid costs: lanes of cells along runs in each version and cell by
// cell, against a plain loop over points that scatters; viscous forces; and a whole step of central differences. Items
// are points: items per second are point-steps per second. All have the forces of the plain loop, or they stop.
#include "pdx/mpm/point_kernel.hpp"

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <string>

namespace {
using namespace pdx;
using mpm::kCorners;

/// A square or cube of full cells, a little displaced and turned.
template <int Dim> struct Body {
  mpm::BodyMaterial material;
  mpm::CellPoints<Dim> points;
  std::vector<mpm::CellRows<Dim>> cells;
  std::vector<mpm::CellRun<Dim>> runs;
  std::vector<double> u, v, r, inverse_mass;

  Body(Index side, int ratio) : material(with_ratio(ratio)), points(material, mpm::full_mask<Dim>(ratio))
  {
    const Index line = side + 1;
    for (Index k = 0; k < (Dim == 2 ? side : side * side); ++k) {
      mpm::CellRun<Dim> run;
      run.cells = side;
      for (Index x = 0; x < side; ++x) {
        mpm::CellRows<Dim> rows;
        for (Index a = 0; a < kCorners<Dim>; ++a) {
          const Index along = Dim == 2 ? a & 1 : a >> 2, next = Dim == 2 ? a >> 1 : a & 1, last = Dim == 2 ? 0 : a >> 1 & 1;
          rows[static_cast<std::size_t>(a)] = ((k / side + last) * line + k % side + next) * line + x + along;
        }
        for (std::size_t l = 0; x == 0 && l < run.first.size(); ++l) run.first[l] = rows[mpm::CellRun<Dim>::corner(l)];
        cells.push_back(rows);
      }
      runs.push_back(run);
    }
    const auto nodes = static_cast<std::size_t>(cells.back().back()) + 1;
    for (std::size_t n = 0; n < nodes; ++n) {
      const double x = static_cast<double>(n % static_cast<std::size_t>(line));
      for (int d = 0; d < Dim; ++d)
        u.push_back(material.side() *
                    (0.01 * std::sin(0.3 * x + 0.01 * static_cast<double>(n) + d) + 0.1 * x * (d == 1)));
    }
    v.assign(u.size(), 0.0);
    r.assign(u.size(), 0.0);
    inverse_mass.assign(nodes, 1.0);
  }
  static mpm::BodyMaterial with_ratio(int ratio)
  {
    return {{200e9, 0.3, law::Plane::stress, 1.0, 7800.0}, mpm::Law::corotational, 1e-3, ratio};
  }
  mpm::NodeFields fields() { return {u.data(), v.data(), r.data(), static_cast<Index>(inverse_mass.size())}; }
  std::int64_t total() const { return static_cast<std::int64_t>(cells.size() * points.sites.size()); }
};

/// As one would write it first: each point finds its hats, its deformation and its stress, and adds to its nodes.
template <int Dim> void scatter(const Body<Dim>& body, std::vector<double>& r)
{
  const law::Corotational<Dim> law(body.material.elastic);
  const double h = body.material.side();
  for (const mpm::CellRows<Dim>& rows : body.cells)
    for (const int site : body.points.sites) {
      const Vector<Dim> place = mpm::site_place<Dim>(body.material.ratio, site);
      double gradient[kCorners<Dim>][Dim], strain[Dim][Dim] = {}, stress[Dim][Dim];
      for (int a = 0; a < kCorners<Dim>; ++a)
        for (int d = 0; d < Dim; ++d) {
          gradient[a][d] = (a >> d & 1 ? 1.0 : -1.0) / h;
          for (int e = 0; e < Dim; ++e)
            if (e != d) gradient[a][d] *= a >> e & 1 ? place[e] : 1.0 - place[e];
        }
      for (int a = 0; a < kCorners<Dim>; ++a) {
        const double* const u = body.u.data() + static_cast<std::ptrdiff_t>(rows[static_cast<std::size_t>(a)]) * Dim;
        for (int c = 0; c < Dim; ++c)
          for (int d = 0; d < Dim; ++d) strain[c][d] += u[c] * gradient[a][d];
      }
      law.stress(strain, stress);
      for (int a = 0; a < kCorners<Dim>; ++a) {
        double* const to = r.data() + static_cast<std::ptrdiff_t>(rows[static_cast<std::size_t>(a)]) * Dim;
        for (int c = 0; c < Dim; ++c)
          for (int d = 0; d < Dim; ++d) to[c] += body.points.volume * stress[c][d] * gradient[a][d];
      }
    }
}

/// Do these forces agree with the plain loop's? One point in a cell has hourglass control besides.
template <int Dim> bool as_scattered(const Body<Dim>& body)
{
  if (body.points.held) return true;
  std::vector<double> plain(body.r.size(), 0.0);
  scatter(body, plain);
  double off = 0.0, size = 0.0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    off = std::max(off, std::abs(plain[i] - body.r[i]));
    size = std::max(size, std::abs(plain[i]));
  }
  return off < 1e-11 * size;
}

template <int Dim, class Work> void measure(benchmark::State& state, Body<Dim>& body, bool elastic, Work&& work)
{
  work();
  if (elastic && !as_scattered(body)) return state.SkipWithError("forces differ from those of the plain loop");
  for ([[maybe_unused]] auto _ : state) {
    work();
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * body.total());
}

template <int Dim> void runs(benchmark::State& state, Index side, int ratio, Processor processor)
{
  if (processor > this_processor()) return state.SkipWithError("not for this processor");
  Body<Dim> body(side, ratio);
  measure(state, body, true, [&] {
    std::ranges::fill(body.r, 0.0);
    mpm::add_run_forces<Dim>(processor, body.material, body.points, body.runs, body.fields());
  });
}
template <int Dim> void cell_by_cell(benchmark::State& state, Index side, int ratio)
{
  Body<Dim> body(side, ratio);
  measure(state, body, true, [&] {
    std::ranges::fill(body.r, 0.0);
    mpm::add_cell_forces<Dim>(chosen_processor(), body.material, body.points, body.cells, body.fields());
  });
}
template <int Dim> void viscous(benchmark::State& state, Index side, int ratio)
{
  Body<Dim> body(side, ratio);
  measure(state, body, false, [&] {
    std::ranges::fill(body.r, 0.0);
    mpm::add_run_viscous<Dim>(chosen_processor(), body.material, body.points, 0.06, body.runs, body.fields());
  });
}
template <int Dim> void plain(benchmark::State& state, Index side, int ratio)
{
  Body<Dim> body(side, ratio);
  measure(state, body, true, [&] {
    std::ranges::fill(body.r, 0.0);
    scatter(body, body.r);
  });
}
/// Forces, accelerations and central differences of all nodes.
template <int Dim> void whole_step(benchmark::State& state, Index side, int ratio)
{
  Body<Dim> body(side, ratio);
  const double step = 1e-25;
  measure(state, body, true, [&] {
    std::ranges::fill(body.r, 0.0);
    mpm::add_run_forces<Dim>(chosen_processor(), body.material, body.points, body.runs, body.fields());
    for (std::size_t n = 0; n < body.inverse_mass.size(); ++n)
      for (std::size_t i = Dim * n; i < Dim * (n + 1); ++i) {
        body.v[i] -= step * body.inverse_mass[n] * body.r[i];
        body.u[i] += step * body.v[i];
      }
  });
}

template <int Dim> void all_of(const std::string& name, Index side, int ratio)
{
  const auto add = [&](const char* kernel, auto run) {
    benchmark::RegisterBenchmark((name + "/" + kernel).c_str(), run)->Unit(benchmark::kMillisecond);
  };
  add("cells", [=](benchmark::State& s) { cell_by_cell<Dim>(s, side, ratio); });
  add("plain_scatter", [=](benchmark::State& s) { plain<Dim>(s, side, ratio); });
  if (!mpm::runs_are_swept(ratio)) return;
  add("runs", [=](benchmark::State& s) { runs<Dim>(s, side, ratio, chosen_processor()); });
  add("runs_avx512", [=](benchmark::State& s) { runs<Dim>(s, side, ratio, Processor::avx512); });
  add("runs_avx2", [=](benchmark::State& s) { runs<Dim>(s, side, ratio, Processor::avx2); });
  add("runs_portable", [=](benchmark::State& s) { runs<Dim>(s, side, ratio, Processor::any); });
  add("viscous", [=](benchmark::State& s) { viscous<Dim>(s, side, ratio); });
  add("whole_step", [=](benchmark::State& s) { whole_step<Dim>(s, side, ratio); });
}
} // namespace

int main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  all_of<2>("plate100_ratio2", 100, 2);
  all_of<2>("plate700_ratio2", 700, 2);
  all_of<2>("plate200_ratio1", 200, 1);
  all_of<2>("plate100_ratio3", 100, 3);
  all_of<3>("cube20_ratio2", 20, 2);
  all_of<3>("cube60_ratio2", 60, 2);
  all_of<3>("cube40_ratio1", 40, 1);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
