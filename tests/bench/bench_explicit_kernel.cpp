// What an explicit step of bonds costs: lane strips in each version against neighbour lists, bond by bond and gathered,
// with finite stretch and overstretched bonds watched; and a whole step of central differences against its forces.
// Items are directed bonds; items per second of two rows of one run are the ratio between them.
#include "pdx/base/petsc.hpp"
#include "pdx/pd/csr_kernel.hpp"
#include "pdx/pd/strip_part.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <memory>

namespace {
using namespace pdx;
using law::Kinematics;
constexpr double kDx = 1e-3, kCritical = 5e-3;
/// Times the displacement, at which most tiles have bonds with |e| in .005 ... .02, and all have some above .1.
constexpr double kSeventh = 20.0, kRoot = 300.0;

/// What is measured: sites per direction, horizon over spacing (the family of a uniform micromodulus goes half a
/// spacing further).
template <int Dim> struct Size {
  Index side;
  double ratio;
};

/// A square or a cube of particles, a little displaced.
template <int Dim> struct Body {
  field::Rows rows;
  std::unique_ptr<pd::LatticePart<Dim>> part;
  std::vector<double> u, v, r, points;
  std::vector<std::int64_t> first{0};
  std::vector<std::int32_t> neighbour;
  std::vector<std::uint8_t> intact;
  std::vector<double> length, weight;

  explicit Body(const Size<Dim>& size)
  {
    geom::Lattice<Dim> lattice;
    lattice.dx = kDx;
    lattice.count.fill(size.side);
    std::vector<Index> sites(static_cast<std::size_t>(lattice.total()));
    for (std::size_t k = 0; k < sites.size(); ++k) sites[k] = static_cast<Index>(k);
    rows = field::Rows::number(PETSC_COMM_SELF, 0, 0, 0, static_cast<Index>(sites.size()));
    pd::StencilOptions options;
    options.dx = kDx;
    options.horizon = size.ratio * kDx;
    options.calibration = pd::Calibration::continuum;
    options.micromodulus = law::Micromodulus::uniform;
    options.elastic = {192e9, law::required_poisson(Dim, law::Plane::stress), law::Plane::stress, 1.0};
    part = std::make_unique<pd::LatticePart<Dim>>(rows, lattice, pd::make_stencil<Dim>(options), sites, 0,
                                                  pd::SurfaceCorrection<Dim>());
    for (const Index site : sites) {
      const Vector<Dim> x = lattice.point(lattice.site(site));
      for (int d = 0; d < Dim; ++d) {
        points.push_back(x[d]);
        u.push_back(2e-4 * kDx * std::sin(900.0 * x.sum() + d));
      }
    }
    v.assign(u.size(), 0.0);
    r.assign(u.size(), 0.0);
  }
  void list_neighbours()
  {
    const auto& arms = part->stencil().half;
    for (Index k = 0; k < static_cast<Index>(part->sites().size()); ++k) {
      part->for_each_bond(k, [&](std::size_t h, int, const Site<Dim>& other, double) {
        neighbour.push_back(static_cast<std::int32_t>(part->lattice().number(other)));
        length.push_back(arms[h].length);
        weight.push_back(arms[h].kappa / arms[h].length);
      });
      first.push_back(static_cast<std::int64_t>(neighbour.size()));
    }
    intact.assign(neighbour.size(), 1);
  }
  pd::CsrView<Dim> list() const
  {
    return {first, neighbour.data(), intact.data(), length.data(), weight.data(), points.data()};
  }
};

/// @param times as far displaced, so that the stretch of bonds asks for another series or for none
template <int Dim> void strips(benchmark::State& state, Size<Dim> size, Processor processor, double times = 1.0)
{
  if (processor > this_processor()) return state.SkipWithError("not for this processor");
  Body<Dim> body(size);
  pd::StripPart<Dim> strip(*body.part, Kinematics::finite, processor);
  strip.watch(times * kCritical);
  for (double& u : body.u) u *= times;
  strip.load(body.u);
  strip.add_force(body.r.data()); // finds the series
  for ([[maybe_unused]] auto _ : state) {
    strip.add_force(body.r.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * 2 * body.part->bonds());
}

template <int Dim> void neighbour_list(benchmark::State& state, Size<Dim> size)
{
  Body<Dim> body(size);
  body.list_neighbours();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(
        pd::add_csr_force<Dim>(body.list(), Kinematics::finite, kCritical, body.u.data(), body.r.data()));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * 2 * body.part->bonds());
}

template <int Dim> void gathered_list(benchmark::State& state, Size<Dim> size)
{
  Body<Dim> body(size);
  body.list_neighbours();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(pd::add_gathered_force<Dim>(this_processor(), body.list(), Kinematics::finite, kCritical,
                                                         body.u.data(), body.r.data()));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * 2 * body.part->bonds());
}

/// Load, force and central differences in row order.
template <int Dim> void whole_step(benchmark::State& state, Size<Dim> size)
{
  Body<Dim> body(size);
  pd::StripPart<Dim> strip(*body.part, Kinematics::finite);
  strip.watch(kCritical);
  const double step = 1e-25, per_mass = 1.0;
  for ([[maybe_unused]] auto _ : state) {
    std::fill(body.r.begin(), body.r.end(), 0.0);
    strip.load(body.u);
    strip.add_force(body.r.data());
    for (std::size_t k = 0; k < body.u.size(); ++k) {
      body.v[k] -= step * per_mass * body.r[k];
      body.u[k] += step * body.v[k];
    }
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * 2 * body.part->bonds());
}

/// One root and one division after another, as one finite bond needs: what a loop over bonds cannot pass.
__attribute__((optimize("no-tree-vectorize"))) void root_and_division(benchmark::State& state)
{
  std::vector<double> x(1024, 1.5), y(1024, 0.5);
  for ([[maybe_unused]] auto _ : state) {
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = 0.3 / (x[k] + std::sqrt(x[k]));
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(x.size()));
}

template <int Dim> void measure(const std::string& name, Size<Dim> size)
{
  const auto add = [&](const char* kernel, auto run) {
    benchmark::RegisterBenchmark((name + "/" + kernel).c_str(), run)->Unit(benchmark::kMillisecond);
  };
  add("strips", [size](benchmark::State& s) { strips<Dim>(s, size, chosen_processor()); });
  add("strips_avx512", [size](benchmark::State& s) { strips<Dim>(s, size, Processor::avx512); });
  add("strips_avx2", [size](benchmark::State& s) { strips<Dim>(s, size, Processor::avx2); });
  add("strips_portable", [size](benchmark::State& s) { strips<Dim>(s, size, Processor::any); });
  add("strips_seventh", [size](benchmark::State& s) { strips<Dim>(s, size, chosen_processor(), kSeventh); });
  add("strips_root", [size](benchmark::State& s) { strips<Dim>(s, size, chosen_processor(), kRoot); });
  add("list", [size](benchmark::State& s) { neighbour_list<Dim>(s, size); });
  add("list_gathered", [size](benchmark::State& s) { gathered_list<Dim>(s, size); });
  add("whole_step", [size](benchmark::State& s) { whole_step<Dim>(s, size); });
}
} // namespace

int main(int argc, char** argv)
{
  benchmark::Initialize(&argc, argv);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return 2;
  benchmark::RegisterBenchmark("root_and_division", root_and_division);
  measure<2>("plate320_48", {320, 3.6});
  measure<2>("plate320_28", {320, 2.6});
  measure<2>("plate88_48", {88, 3.6});
  measure<3>("cube47_122", {47, 2.6});
  benchmark::RunSpecifiedBenchmarks();
  PetscFinalize();
  return 0;
}
