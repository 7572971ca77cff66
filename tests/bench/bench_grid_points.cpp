// What an explicit step of material points costs on a grid that is made anew: lanes of cells with each kind of shape
// function, and a plain loop over points that scatters to nodes with hats. Items are points: items per second are
// point-steps per second. The plain loop and the lanes move points alike, or they stop.
#include "pdx/law/solid_law.hpp"
#include "pdx/mpm/grid_motion.hpp"

#include <benchmark/benchmark.h>
#include <cmath>
#include <string>

namespace {
using namespace pdx;
using mpm::GridPoint;

constexpr double kSpacing = 1e-3;

mpm::BodyMaterial material()
{
  return {{1e6, 0.3, law::Plane::stress, 1.0, 1000.0}, mpm::Law::corotational, kSpacing, 2};
}
double step_length() { return 0.3 * 2.0 * kSpacing / std::sqrt(1e6 / 0.91 / 1000.0); }

/// A square or cube that flies at a fiftieth of the speed of sound and rings a little.
template <int Dim> std::vector<GridPoint<Dim>> body(Index side)
{
  std::vector<GridPoint<Dim>> points;
  const Index count = Dim == 2 ? side * side : side * side * side;
  for (Index k = 0; k < count; ++k) {
    GridPoint<Dim> p;
    p.id = k;
    for (int d = 0, rest = k; d < Dim; ++d, rest /= side) p.at[d] = 0.5 * (rest % side + 0.5) + 8.1;
    p.v[0] = 0.7;
    for (int d = 0; d < Dim; ++d) p.v[d] += 0.05 * std::sin(0.3 * p.at.sum() + d);
    points.push_back(p);
  }
  return points;
}

/// As one would write it first, MUSL with hats: each point finds its nodes anew in each sweep.
template <int Dim> struct Plain {
  static constexpr int kCorners = 1 << Dim;
  struct Node {
    double mass = 0.0, v[Dim] = {}, a[Dim] = {}, brought[Dim] = {};
  };
  std::vector<GridPoint<Dim>> points;
  std::vector<Node> nodes;
  std::ptrdiff_t along;

  explicit Plain(Index side) : points(body<Dim>(side)), along(side / 2 + 40)
  {
    nodes.resize(static_cast<std::size_t>(std::pow(along, Dim)));
  }
  template <class Visit> void for_each_corner(const GridPoint<Dim>& p, Visit&& visit)
  {
    std::ptrdiff_t first = 0;
    double in[Dim];
    for (int d = Dim; d-- > 0;) {
      const auto cell = static_cast<std::ptrdiff_t>(p.at[d]);
      in[d] = p.at[d] - static_cast<double>(cell);
      first = first * along + cell;
    }
    for (int k = 0; k < kCorners; ++k) {
      std::ptrdiff_t at = first;
      double n = 1.0, g[Dim];
      for (int d = 0; d < Dim; ++d) {
        at += (k >> d & 1) * (d == 0 ? 1 : d == 1 ? along : along * along);
        n *= k >> d & 1 ? in[d] : 1.0 - in[d];
        g[d] = k >> d & 1 ? 1.0 : -1.0;
        for (int e = 0; e < Dim; ++e)
          if (e != d) g[d] *= k >> e & 1 ? in[e] : 1.0 - in[e];
      }
      visit(nodes[static_cast<std::size_t>(at)], n, g);
    }
  }
  void step(double dt)
  {
    const mpm::BodyMaterial of = material();
    const law::Corotational<Dim> law(of.elastic);
    const double h = of.side(), volume = mpm::point_volume<Dim>(of), mass = of.elastic.density * volume;
    std::fill(nodes.begin(), nodes.end(), Node{});
    for (const auto& p : points) {
      double strain[Dim][Dim], stress[Dim][Dim], kirchhoff[Dim][Dim];
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) strain[i][j] = p.h(i, j);
      law.stress(strain, stress);
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) {
          kirchhoff[i][j] = stress[i][j];
          for (int k = 0; k < Dim; ++k) kirchhoff[i][j] += stress[i][k] * strain[j][k];
        }
      for_each_corner(p, [&](Node& node, double n, const double* g) {
        node.mass += mass * n;
        for (int i = 0; i < Dim; ++i) {
          node.v[i] += mass * n * p.v[i];
          for (int j = 0; j < Dim; ++j) node.a[i] -= volume / h * kirchhoff[i][j] * g[j];
        }
      });
    }
    for (Node& node : nodes)
      if (node.mass > 0.0)
        for (double& a : node.a) a /= node.mass;
    for (auto& p : points) {
      for_each_corner(p, [&](const Node& node, double n, const double*) {
        for (int i = 0; i < Dim; ++i) p.v[i] += dt * n * node.a[i];
      });
      for_each_corner(p, [&](Node& node, double n, const double*) {
        for (int i = 0; i < Dim; ++i) node.brought[i] += mass * n * p.v[i];
      });
    }
    for (Node& node : nodes)
      if (node.mass > 0.0)
        for (double& v : node.brought) v /= node.mass;
    for (auto& p : points) {
      Tensor<Dim> rate = Tensor<Dim>::Zero();
      Vector<Dim> there = Vector<Dim>::Zero();
      for_each_corner(p, [&](const Node& node, double n, const double* g) {
        for (int i = 0; i < Dim; ++i) {
          there[i] += n * node.brought[i];
          for (int j = 0; j < Dim; ++j) rate(i, j) += node.brought[i] * g[j];
        }
      });
      p.h += dt / h * (rate + rate * p.h).eval();
      p.at += dt / h * there;
    }
  }
};

template <int Dim> mpm::GridMotion<Dim> motion(Index side, mpm::Shape shape)
{
  mpm::GridRule rule;
  rule.shape = shape;
  rule.side = material().side();
  return {PETSC_COMM_SELF, rule, Vector<Dim>::Zero(), {material()}, {body<Dim>(side)}};
}

template <int Dim> bool alike(Index side)
{
  Plain<Dim> plain(side);
  auto lanes = motion<Dim>(side, mpm::Shape::hat);
  for (int k = 0; k < 3; ++k) {
    plain.step(step_length());
    lanes.step(0.0, step_length(), step_length());
  }
  const auto points = lanes.points(0);
  for (std::size_t k = 0; k < points.size(); ++k)
    if ((points[k].at - plain.points[k].at).norm() > 1e-11 || (points[k].h - plain.points[k].h).norm() > 1e-11)
      return false;
  return true;
}

template <int Dim> void lanes(benchmark::State& state, Index side, mpm::Shape shape)
{
  auto all = motion<Dim>(side, shape);
  all.step(0.0, step_length(), step_length());
  for ([[maybe_unused]] auto _ : state) all.step(0.0, step_length(), step_length());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.lanes(0).size()));
}
template <int Dim> void plain_scatter(benchmark::State& state, Index side)
{
  if (!alike<Dim>(Dim == 2 ? 24 : 8)) return state.SkipWithError("the plain loop moves points otherwise");
  Plain<Dim> all(side);
  const std::vector<GridPoint<Dim>> begin = all.points;
  int steps = 0;
  for ([[maybe_unused]] auto _ : state) {
    all.step(step_length());
    if (++steps % 500 == 0) all.points = begin; // it has a grid with ends
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(all.points.size()));
}

template <int Dim> void all_of(const std::string& name, Index side)
{
  const auto add = [&](const char* kernel, auto run) {
    benchmark::RegisterBenchmark((name + "/" + kernel).c_str(), run)->Unit(benchmark::kMillisecond);
  };
  add("hat", [=](benchmark::State& s) { lanes<Dim>(s, side, mpm::Shape::hat); });
  add("gimp", [=](benchmark::State& s) { lanes<Dim>(s, side, mpm::Shape::gimp); });
  add("bspline", [=](benchmark::State& s) { lanes<Dim>(s, side, mpm::Shape::bspline); });
  add("plain_scatter", [=](benchmark::State& s) { plain_scatter<Dim>(s, side); });
}
} // namespace

int main(int argc, char** argv)
{
  PDX_CALL(PetscInitialize(&argc, &argv, nullptr, nullptr)); // whose log events are timed
  benchmark::Initialize(&argc, argv);
  all_of<2>("grid320", 320);
  all_of<2>("grid80", 80);
  all_of<3>("grid48cube", 48);
  benchmark::RunSpecifiedBenchmarks();
  PDX_CALL(PetscFinalize());
  return 0;
}
