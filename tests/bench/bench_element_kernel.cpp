// What a step of elements costs: rectangles in rows and any cells in lanes, in each version, against one element after
// the other (the kernel that tangents are derived from) and against one stiffness for all. Items are elements; items
// per second of two rows of one run are the ratio between them.
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/fem/element_action.hpp"
#include "pdx/fem/sweep_kernel.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <string>
#include <vector>

namespace {
using namespace pdx;
using law::Kinematics;
constexpr double kSide = 1e-3;

/// Square elements in a square, or cells whose corners are shifted by up to a fifth of a side, a little displaced.
struct Plate {
  law::Elastic law{192e9, 1.0 / 3.0, law::Plane::stress, 1e-4};
  std::vector<fem::Corners> corners;
  std::vector<std::array<Index, 4>> rows;
  std::vector<fem::RectangleRun> runs;
  std::vector<double> u, r;

  Plate(Index side, double shift)
  {
    const Index nodes = side + 1;
    const auto point = [&](Index n) {
      return Vector<2>{kSide * (n % nodes + shift * std::sin(7.0 * n)),
                       kSide * (n / nodes + shift * std::cos(5.0 * n))};
    };
    for (Index n = 0; n < nodes * nodes; ++n)
      for (int d = 0; d < 2; ++d) u.push_back(1e-2 * kSide * std::sin(900.0 * point(n).sum() + d));
    r.assign(u.size(), 0.0);
    for (Index j = 0; j < side; ++j) {
      runs.push_back({{j * nodes, (j + 1) * nodes}, side, kSide, kSide, false});
      for (Index i = 0; i < side; ++i) {
        const Index n = j * nodes + i;
        rows.push_back({n, n + 1, n + nodes + 1, n + nodes});
        corners.push_back({point(n), point(n + 1), point(n + nodes + 1), point(n + nodes)});
      }
    }
  }
  fem::SweepFields fields()
  {
    const auto count = static_cast<std::ptrdiff_t>(u.size() / 2);
    return {u.data(), count, r.data(), count};
  }
  fem::ElementVector displacement(std::size_t k) const
  {
    fem::ElementVector d;
    for (int a = 0; a < 4; ++a) d.segment<2>(2 * a) << u[2 * at(k, a)], u[2 * at(k, a) + 1];
    return d;
  }
  void add(std::size_t k, const fem::ElementVector& force)
  {
    for (int a = 0; a < 4; ++a)
      for (std::size_t d = 0; d < 2; ++d) r[2 * at(k, a) + d] += force[2 * a + static_cast<int>(d)];
  }
  std::size_t at(std::size_t k, int a) const { return static_cast<std::size_t>(rows[k][static_cast<std::size_t>(a)]); }
};

template <class Sweep> void measure(benchmark::State& state, Plate& plate, Sweep sweep)
{
  for ([[maybe_unused]] auto _ : state) {
    sweep();
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(plate.rows.size()));
}

void one_by_one(benchmark::State& state, Index side, double shift, Kinematics kinematics)
{
  Plate plate(side, shift);
  measure(state, plate, [&] {
    for (std::size_t k = 0; k < plate.rows.size(); ++k)
      plate.add(k, fem::element_force(plate.corners[k], plate.displacement(k), plate.law, kinematics));
  });
}

void shared_stiffness(benchmark::State& state, Index side)
{
  Plate plate(side, 0.0);
  const fem::ElementMatrix k =
      fem::element_tangent(plate.corners[0], fem::ElementVector::Zero(), plate.law, Kinematics::small);
  measure(state, plate, [&] {
    fem::add_element_action(std::span<const double, 64>(k.data(), 64), plate.rows, plate.u.data(), plate.r.data());
  });
}

void kept_stiffness(benchmark::State& state, Index side, double shift)
{
  Plate plate(side, shift);
  std::vector<fem::ElementMatrix> kept;
  for (const fem::Corners& corners : plate.corners)
    kept.push_back(fem::element_tangent(corners, fem::ElementVector::Zero(), plate.law, Kinematics::small));
  measure(state, plate, [&] {
    for (std::size_t k = 0; k < plate.rows.size(); ++k) {
      fem::ElementVector force;
      force.noalias() = kept[k] * plate.displacement(k);
      plate.add(k, force);
    }
  });
}

template <class Elements>
void sweep(Processor processor, const Elements& elements, Plate& plate, Kinematics kinematics, bool energy)
{
  if (energy)
    benchmark::DoNotOptimize(fem::sweep_energy(processor, elements, plate.law, kinematics, plate.fields()));
  else
    fem::add_sweep_forces(processor, elements, plate.law, kinematics, plate.fields());
}

void in_rows(benchmark::State& state, Index side, Kinematics kinematics, bool energy, Processor processor)
{
  if (processor > this_processor()) return state.SkipWithError("not for this processor");
  Plate plate(side, 0.0);
  measure(state, plate, [&] { sweep(processor, plate.runs, plate, kinematics, energy); });
}

void in_lanes(benchmark::State& state, Index side, double shift, Kinematics kinematics, bool energy,
              Processor processor)
{
  if (processor > this_processor()) return state.SkipWithError("not for this processor");
  Plate plate(side, shift);
  fem::QuadBlocks blocks = fem::quad_blocks(processor, plate.corners, plate.rows);
  blocks.inside = true;
  measure(state, plate, [&] { sweep(processor, blocks, plate, kinematics, energy); });
}

void add_all()
{
  constexpr double shift = 0.2;
  const std::pair<Kinematics, const char*> kinds[] = {{Kinematics::finite, "finite"}, {Kinematics::small, "linear"}};
  const std::pair<Processor, const char*> processors[] = {
      {Processor::avx512, "_avx512"}, {Processor::avx2, "_avx2"}, {Processor::any, "_portable"}};
  for (const Index side : {49, 500})
    for (const auto& [kind, word] : kinds) {
      const std::string start = "plate" + std::to_string(side) + "/" + word + "/";
      const auto add = [&](const std::string& name, auto run) {
        benchmark::RegisterBenchmark((start + name).c_str(), run);
      };
      const Kinematics kinematics = kind;
      add("one_by_one", [=](benchmark::State& s) { one_by_one(s, side, 0.0, kinematics); });
      add("one_by_one_skewed", [=](benchmark::State& s) { one_by_one(s, side, shift, kinematics); });
      if (kinematics == Kinematics::small) {
        add("shared_stiffness", [=](benchmark::State& s) { shared_stiffness(s, side); });
        add("kept_stiffness_skewed", [=](benchmark::State& s) { kept_stiffness(s, side, shift); });
      }
      for (const auto& [processor, version] : processors)
        for (const bool energy : {false, true}) {
          const Processor p = processor;
          const char* const what = energy ? "_energy" : "";
          add(std::string("rows") + version + what,
              [=](benchmark::State& s) { in_rows(s, side, kinematics, energy, p); });
          add(std::string("lanes") + version + what,
              [=](benchmark::State& s) { in_lanes(s, side, shift, kinematics, energy, p); });
        }
    }
}
} // namespace

int main(int count, char** words)
{
  benchmark::Initialize(&count, words);
  if (benchmark::ReportUnrecognizedArguments(count, words)) return 1;
  add_all();
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
