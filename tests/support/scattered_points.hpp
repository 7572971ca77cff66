#pragma once
#include "pdx/law/solid_law.hpp"
#include "pdx/mpm/grid_kernel.hpp"

#include <cmath>
#include <map>
#include <vector>

namespace pdx::test {
/// Points on a grid that is made anew each step, as one would write it first: each point finds its nodes by formula and
/// scatters to them. Corotational.
template <int Dim> struct ScatteredPoints {
  mpm::GridRule rule;
  mpm::BodyMaterial body;
  std::vector<mpm::GridPoint<Dim>> points;

  struct Node {
    double mass = 0.0;
    Vector<Dim> momentum = Vector<Dim>::Zero(), force = Vector<Dim>::Zero(), brought = Vector<Dim>::Zero();
    Vector<Dim> v = Vector<Dim>::Zero(), a = Vector<Dim>::Zero();
  };

  /// S(d) of a node at distance d, in sides of a cell: the papers' pieces.
  double value(double d) const
  {
    const double r = std::abs(d), l = 0.5 * body.spacing / rule.side;
    if (rule.shape == mpm::Shape::hat) return r < 1.0 ? 1.0 - r : 0.0;
    if (rule.shape == mpm::Shape::bspline) return r < 0.5 ? 0.75 - r * r : r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0.0;
    if (r < l) return 1.0 - (r * r + l * l) / (2.0 * l);
    if (r < 1.0 - l) return 1.0 - r;
    return r < 1.0 + l ? (1.0 + l - r) * (1.0 + l - r) / (4.0 * l) : 0.0;
  }
  double slope(double d) const
  {
    const double r = std::abs(d), sign = d < 0.0 ? -1.0 : 1.0, l = 0.5 * body.spacing / rule.side;
    if (rule.shape == mpm::Shape::hat) return r < 1.0 ? -sign : 0.0;
    if (rule.shape == mpm::Shape::bspline) return r < 0.5 ? -2.0 * d : r < 1.5 ? -sign * (1.5 - r) : 0.0;
    if (r < l) return -d / l;
    if (r < 1.0 - l) return -sign;
    return r < 1.0 + l ? -sign * (1.0 + l - r) / (2.0 * l) : 0.0;
  }

  /// Calls visit(node, N, grad N in 1/h) for every node that may see a point.
  template <class Visit> void for_each_node(const mpm::GridPoint<Dim>& p, Visit&& visit)
  {
    const int along = 4;
    for (int k = 0; k < (Dim == 2 ? along * along : along * along * along); ++k) {
      Site<Dim> at;
      double n = 1.0;
      Vector<Dim> g = Vector<Dim>::Ones();
      for (int d = 0, rest = k; d < Dim; ++d, rest /= along) {
        at[static_cast<std::size_t>(d)] = static_cast<Index>(std::floor(p.at[d])) - 1 + rest % along;
        const double off = p.at[d] - at[static_cast<std::size_t>(d)];
        n *= value(off);
        for (int e = 0; e < Dim; ++e) g[e] *= e == d ? slope(off) : value(off);
      }
      if (n > 0.0) visit(nodes[at], n, g);
    }
  }

  void step(double dt)
  {
    const double volume = mpm::point_volume<Dim>(body), mass = body.elastic.density * volume, h = rule.side;
    const law::Corotational<Dim> law(body.elastic);
    const auto bring = [&] {
      for (auto& p : points)
        for_each_node(p, [&](Node& node, double n, const Vector<Dim>&) {
          node.mass += mass * n;
          node.momentum += mass * n * p.v;
        });
    };
    const auto pull = [&] {
      for (auto& p : points) {
        double strain[Dim][Dim], stress[Dim][Dim];
        for (int i = 0; i < Dim; ++i)
          for (int j = 0; j < Dim; ++j) strain[i][j] = p.h(i, j);
        law.stress(strain, stress);
        Tensor<Dim> first;
        for (int i = 0; i < Dim; ++i)
          for (int j = 0; j < Dim; ++j) first(i, j) = stress[i][j];
        const Tensor<Dim> kirchhoff = first * (Tensor<Dim>::Identity() + p.h).transpose();
        for_each_node(p, [&](Node& node, double, const Vector<Dim>& g) { node.force -= volume / h * (kirchhoff * g); });
      }
    };
    const auto stretch = [&] {
      for (auto& p : points) {
        Tensor<Dim> rate = Tensor<Dim>::Zero();
        for_each_node(p, [&](Node& node, double, const Vector<Dim>& g) { rate += node.v * g.transpose() / h; });
        p.h = (Tensor<Dim>::Identity() + dt * rate) * (Tensor<Dim>::Identity() + p.h) - Tensor<Dim>::Identity();
      }
    };
    nodes.clear();
    bring();
    if (rule.order == mpm::Order::usf) {
      for (auto& [at, node] : nodes) node.v = node.momentum / node.mass;
      stretch();
    }
    pull();
    for (auto& [at, node] : nodes) {
      node.a = node.force / node.mass;
      node.v = node.momentum / node.mass + (node.mass > 1e-6 * mass ? dt : 0.0) * node.a;
    }
    for (auto& p : points) {
      Vector<Dim> change = Vector<Dim>::Zero(), there = Vector<Dim>::Zero();
      for_each_node(p, [&](Node& node, double n, const Vector<Dim>&) {
        change += dt * n * node.a;
        there += n * node.v;
      });
      p.v = (1.0 - rule.pic) * (p.v + change) + rule.pic * there;
    }
    if (rule.order == mpm::Order::musl) {
      for (auto& p : points)
        for_each_node(p, [&](Node& node, double n, const Vector<Dim>&) { node.brought += mass * n * p.v; });
      for (auto& [at, node] : nodes) node.v = node.brought / node.mass;
    }
    if (rule.order != mpm::Order::usf) stretch();
    for (auto& p : points) {
      Vector<Dim> there = Vector<Dim>::Zero();
      for_each_node(p, [&](Node& node, double n, const Vector<Dim>&) { there += n * node.v; });
      p.at += dt / h * there;
    }
  }

  std::map<Site<Dim>, Node> nodes;
};
} // namespace pdx::test
