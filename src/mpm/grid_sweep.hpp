#pragma once
#include "grid_lanes.hpp"

/// What points give to nodes and take from them, W of a block's eight lanes at a time.
namespace pdx::mpm {
/// Points give mass and momentum, or forces, or both.
template <int W, int Dim, class Shape, class Law, bool Momentum, bool Force> struct GiveSweep {
  static constexpr int kReach = Shape::kReach, kNodes = grid_power(kReach, Dim);
  const Shape& shape;
  const Law& law;
  double mass, volume, per_side; ///< of a point [kg], [m^3]; 1 / h [1/m]
  const Vector<Dim>& push;
  const PointLanes<Dim>& points;
  const NodeView<Dim>& nodes;
  SomeBlocks blocks;

  PDX_INLINE void all() const
  {
    const std::span<const typename PointLanes<Dim>::Block> mine = blocks.of(points.blocks());
    for (std::size_t k = 0; k < mine.size(); ++k) {
      if (mine[k].slots && k + 1 < mine.size()) fetch(mine[k + 1]);
      for (int lane = 0; mine[k].slots && lane < PointLanes<Dim>::kLanes; lane += W) {
        const SomeLanes<W, Dim> lanes(mine[k], lane);
        if (lanes.slots) some(lanes);
      }
    }
  }
  /// Who gives is the first to read a point in a step, and blocks are longer than what the processor foresees.
  PDX_INLINE void fetch(const typename PointLanes<Dim>::Block& next) const
  {
    constexpr std::size_t line = 8;
    const double* const from = points.slot(next, 0);
    for (std::size_t n = 0; n < static_cast<std::size_t>(next.slots) * PointLanes<Dim>::kSlot; n += line)
      __builtin_prefetch(from + n);
  }
  PDX_INLINE void some(const SomeLanes<W, Dim>& lanes) const
  {
    Lanes<W> m[Momentum ? kNodes : 1] = {}, p[Momentum ? Dim : 1][Momentum ? kNodes : 1] = {},
                                   f[Force ? Dim : 1][Force ? kNodes : 1] = {};
    for (int s = 0; s < lanes.slots; ++s) {
      const double* const numbers = points.slot(lanes.block, s) + lanes.lane;
      Lanes<W> at[Dim];
      load_numbers<W, Dim>(numbers, at);
      const Weights<W, Dim, Shape> weights(shape, lanes, at);
      const Lanes<W> live = lanes.live(s);
      if constexpr (Momentum) {
        Lanes<W> v[Dim];
        load_numbers<W, Dim>(numbers + Dim * PointLanes<Dim>::kLanes, v);
        const Lanes<W> here = live * mass;
        PDX_UNROLL
        for (int k = 0; k < kNodes; ++k) {
          const Lanes<W> share = here * weights.value(k);
          m[k] += share;
          PDX_UNROLL
          for (int d = 0; d < Dim; ++d) p[d][k] += share * v[d];
        }
      }
      if constexpr (Force) add_force(numbers, live * volume, weights, f);
    }
    const std::ptrdiff_t first = first_node<Dim, Shape>(nodes, lanes.block.cell, lanes.lane);
    if constexpr (Momentum) add_all<W, Dim, kReach>(m, nodes, nodes.mass + first);
    PDX_UNROLL
    for (int d = 0; d < Dim; ++d) {
      if constexpr (Momentum) add_all<W, Dim, kReach>(p[d], nodes, nodes.velocity[static_cast<std::size_t>(d)] + first);
      if constexpr (Force) add_all<W, Dim, kReach>(f[d], nodes, nodes.pull[static_cast<std::size_t>(d)] + first);
    }
  }
  /// -V0 P F^T grad N, and what pushes.
  PDX_INLINE void add_force(const double* numbers, Lanes<W> here, const Weights<W, Dim, Shape>& weights,
                            Lanes<W> (&f)[Force ? Dim : 1][Force ? kNodes : 1]) const
  {
    Lanes<W> h[Dim][Dim], first[Dim][Dim], kirchhoff[Dim][Dim];
    load_strain<W, Dim>(numbers, h);
    law.stress(h, first);
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = i; j < Dim; ++j) {
        Lanes<W> sum = first[i][j];
        PDX_UNROLL
        for (int k = 0; k < Dim; ++k) sum += first[i][k] * h[j][k];
        kirchhoff[i][j] = kirchhoff[j][i] = -per_side * here * sum;
      }
    const Lanes<W> one = here * (1.0 / volume);
    PDX_UNROLL
    for (int k = 0; k < kNodes; ++k) {
      const Lanes<W> value = one * weights.value(k);
      PDX_UNROLL
      for (int i = 0; i < Dim; ++i) f[i][k] += value * push[i];
      PDX_UNROLL
      for (int j = 0; j < Dim; ++j) {
        const Lanes<W> slope = weights.slope(k, j);
        PDX_UNROLL
        for (int i = 0; i < Dim; ++i) f[i][k] += kirchhoff[i][j] * slope;
      }
    }
  }
};

/// Points take from nodes.
template <int W, int Dim, class Shape, bool Velocity, bool Brings, bool Strain, bool Place> struct TakeSweep {
  static constexpr int kReach = Shape::kReach, kNodes = grid_power(kReach, Dim), kLanes = PointLanes<Dim>::kLanes;
  const Shape& shape;
  const Taking& what;
  double mass, pic, per_side; ///< of a point [kg]; share of PIC [-]; 1 / h [1/m]
  double begin;
  PointLanes<Dim>& points;
  const NodeView<Dim>& nodes;
  Vector<Dim>& way; ///< of all points together [m]

  PDX_INLINE void all() const
  {
    Lanes<W> gone[Dim] = {};
    for (auto& block : what.blocks.of(points.blocks()))
      for (int lane = 0; block.slots && lane < kLanes; lane += W) {
        const SomeLanes<W, Dim> lanes(block, lane);
        if (lanes.slots && some(lanes, gone)) block.crossed = 1;
      }
    for (int d = 0; d < Dim; ++d)
      for (int l = 0; l < W; ++l) way[d] += gone[d][l];
  }

private:
  PDX_INLINE void load_nodes_of(const std::array<double*, Dim>& from, std::ptrdiff_t first,
                                Lanes<W> (&to)[Dim][kNodes]) const
  {
    PDX_UNROLL
    for (int d = 0; d < Dim; ++d)
      for (int k = 0; k < kNodes; ++k)
        to[d][k] = load<W>(from[static_cast<std::size_t>(d)] + first + line_start<Dim, kReach>(nodes, k / kReach) +
                           k % kReach);
  }
  static PDX_INLINE void keep(Lanes<W> live, Lanes<W> value, double* to)
  {
    store<W>(live > 0.0 ? value : load<W>(to), to);
  }

  PDX_INLINE bool some(const SomeLanes<W, Dim>& lanes, Lanes<W> (&gone)[Dim]) const
  {
    const std::ptrdiff_t first = first_node<Dim, Shape>(nodes, lanes.block.cell, lanes.lane);
    const bool mixes = Velocity && pic > 0.0;
    Lanes<W> a[Velocity ? Dim : 1][Velocity ? kNodes : 1], v[Dim][kNodes],
        sum[Brings ? Dim : 1][Brings ? kNodes : 1] = {};
    if constexpr (Velocity) load_nodes_of(nodes.pull, first, a);
    if constexpr (Strain || Place)
      load_nodes_of(what.brought ? nodes.brought : nodes.velocity, first, v);
    else if (mixes)
      load_nodes_of(nodes.velocity, first, v);
    Lanes<W> out{};
    for (int s = 0; s < lanes.slots; ++s) {
      double* const numbers = points.slot(lanes.block, s) + lanes.lane;
      const Lanes<W> live = lanes.live(s);
      Lanes<W> at[Dim];
      load_numbers<W, Dim>(numbers, at);
      const Weights<W, Dim, Shape> weights(shape, lanes, at);
      if constexpr (Velocity) {
        Lanes<W> now[Dim];
        load_numbers<W, Dim>(numbers + Dim * kLanes, now);
        kick(weights, a, v, mixes, now);
        PDX_UNROLL
        for (int d = 0; d < Dim; ++d) keep(live, now[d], numbers + (Dim + d) * kLanes);
        if constexpr (Brings) {
          const Lanes<W> here = live * mass;
          PDX_UNROLL
          for (int k = 0; k < kNodes; ++k) {
            const Lanes<W> share = here * weights.value(k);
            PDX_UNROLL
            for (int d = 0; d < Dim; ++d) sum[d][k] += share * now[d];
          }
        }
      }
      if constexpr (Strain) strain(weights, v, live, numbers);
      if constexpr (Place) out += live * move(lanes, weights, v, live, at, gone, numbers);
    }
    if constexpr (Brings)
      for (int d = 0; d < Dim; ++d)
        add_all<W, Dim, kReach>(sum[d], nodes, nodes.brought[static_cast<std::size_t>(d)] + first);
    double crossed = 0.0;
    if constexpr (Place)
      for (int l = 0; l < W; ++l) crossed += out[l];
    return crossed != 0.0;
  }
  PDX_INLINE void kick(const Weights<W, Dim, Shape>& weights,
                       const Lanes<W> (&a)[Velocity ? Dim : 1][Velocity ? kNodes : 1], const Lanes<W> (&v)[Dim][kNodes],
                       bool mixes, Lanes<W> (&now)[Dim]) const
  {
    PDX_UNROLL
    for (int d = 0; d < Dim; ++d) {
      Lanes<W> change{};
      PDX_UNROLL
      for (int k = 0; k < kNodes; ++k) change += weights.value(k) * a[d][k];
      now[d] += what.kick * change;
    }
    if (!mixes) return;
    PDX_UNROLL
    for (int d = 0; d < Dim; ++d) {
      Lanes<W> there{};
      PDX_UNROLL
      for (int k = 0; k < kNodes; ++k) there += weights.value(k) * v[d][k];
      now[d] = (1.0 - pic) * now[d] + pic * there;
    }
  }
  /// F := (I + dt L) F.
  PDX_INLINE void strain(const Weights<W, Dim, Shape>& weights, const Lanes<W> (&v)[Dim][kNodes], Lanes<W> live,
                         double* numbers) const
  {
    Lanes<W> rate[Dim][Dim] = {}, h[Dim][Dim];
    PDX_UNROLL
    for (int j = 0; j < Dim; ++j)
      for (int k = 0; k < kNodes; ++k) {
        const Lanes<W> slope = weights.slope(k, j);
        PDX_UNROLL
        for (int i = 0; i < Dim; ++i) rate[i][j] += v[i][k] * slope;
      }
    load_strain<W, Dim>(numbers, h);
    PDX_UNROLL
    for (int i = 0; i < Dim; ++i)
      for (int j = 0; j < Dim; ++j) {
        Lanes<W> grown = rate[i][j];
        PDX_UNROLL
        for (int k = 0; k < Dim; ++k) grown += rate[i][k] * h[k][j];
        keep(live, h[i][j] + (what.step * per_side) * grown, numbers + (2 * Dim + Dim * i + j) * kLanes);
      }
  }
  /// @return who is in another cell then, or nowhere
  PDX_INLINE Lanes<W> move(const SomeLanes<W, Dim>& lanes, const Weights<W, Dim, Shape>& weights,
                           const Lanes<W> (&v)[Dim][kNodes], Lanes<W> live, Lanes<W> (&at)[Dim], Lanes<W> (&gone)[Dim],
                           double* numbers) const
  {
    Lanes<W> out{};
    PDX_UNROLL
    for (int d = 0; d < Dim; ++d) {
      Lanes<W> there{};
      PDX_UNROLL
      for (int k = 0; k < kNodes; ++k) there += weights.value(k) * v[d][k];
      const Lanes<W> by = live * (what.step * there);
      gone[d] += by;
      at[d] += per_side * by;
      keep(live, at[d], numbers + d * kLanes);
      const Lanes<W> off = lanes.within(d, at[d]) - (begin + 0.5);
      out += off * off <= Lanes<W>{} + 0.25 ? Lanes<W>{} : Lanes<W>{} + 1.0;
    }
    return out;
  }
};

/// Versions of `give` and `take` for `run_on`.
template <int Dim, class Shape, class Law, bool Momentum, bool Force> struct Give {
  const Shape& shape;
  const Law& law;
  double mass, volume, per_side;
  const Vector<Dim>& push;
  const PointLanes<Dim>& points;
  const NodeView<Dim>& nodes;
  SomeBlocks blocks;
  template <int W> PDX_INLINE void run() const
  {
    GiveSweep<W, Dim, Shape, Law, Momentum, Force>{shape, law, mass, volume, per_side, push, points, nodes, blocks}
        .all();
  }
};
template <int Dim, class Shape, bool Velocity, bool Brings, bool Strain, bool Place> struct Take {
  const Shape& shape;
  const Taking& what;
  double mass, pic, per_side, begin;
  PointLanes<Dim>& points;
  const NodeView<Dim>& nodes;
  Vector<Dim>& way;
  template <int W> PDX_INLINE void run() const
  {
    TakeSweep<W, Dim, Shape, Velocity, Brings, Strain, Place>{shape, what,   mass,  pic, per_side,
                                                              begin, points, nodes, way}
        .all();
  }
};

template <int Dim, class Shape, class Law>
void give_by(Processor processor, const GridRule& rule, const BodyMaterial& body, const Giving& what,
             const Vector<Dim>& push, const PointLanes<Dim>& points, const NodeView<Dim>& nodes)
{
  const Law law(body.elastic);
  const Shape shape(0.5 * body.spacing / rule.side);
  const double volume = point_volume<Dim>(body), mass = body.elastic.density * volume, per_side = 1.0 / rule.side;
  if (what.momentum && what.force)
    run_on(processor,
           Give<Dim, Shape, Law, true, true>{shape, law, mass, volume, per_side, push, points, nodes, what.blocks});
  else if (what.momentum)
    run_on(processor,
           Give<Dim, Shape, Law, true, false>{shape, law, mass, volume, per_side, push, points, nodes, what.blocks});
  else
    run_on(processor,
           Give<Dim, Shape, Law, false, true>{shape, law, mass, volume, per_side, push, points, nodes, what.blocks});
}

template <int Dim, class Shape>
void give_with(Processor processor, const GridRule& rule, const BodyMaterial& body, const Giving& what,
               const Vector<Dim>& push, const PointLanes<Dim>& points, const NodeView<Dim>& nodes)
{
  if (body.law == Law::corotational)
    give_by<Dim, Shape, law::Corotational<Dim>>(processor, rule, body, what, push, points, nodes);
  else
    give_by<Dim, Shape, law::NeoHooke<Dim>>(processor, rule, body, what, push, points, nodes);
}

template <int Dim, class Shape>
Vector<Dim> take_with(Processor processor, const GridRule& rule, const BodyMaterial& body, const Taking& what,
                      PointLanes<Dim>& points, const NodeView<Dim>& nodes)
{
  const Shape shape(0.5 * body.spacing / rule.side);
  const double mass = body.elastic.density * point_volume<Dim>(body), per_side = 1.0 / rule.side,
               begin = points.begin();
  Vector<Dim> way = Vector<Dim>::Zero();
  const auto run = [&]<bool Velocity, bool Brings, bool Strain, bool Place>() {
    run_on(processor, Take<Dim, Shape, Velocity, Brings, Strain, Place>{shape, what, mass, rule.pic, per_side, begin,
                                                                        points, nodes, way});
  };
  if (what.velocity && what.giving)
    what.place ? run.template operator()<true, true, false, true>()
               : run.template operator()<true, true, false, false>();
  else if (what.velocity)
    what.strain ? run.template operator()<true, false, true, true>()
                : run.template operator()<true, false, false, true>();
  else
    what.place ? run.template operator()<false, false, true, true>()
               : run.template operator()<false, false, true, false>();
  return way;
}
} // namespace pdx::mpm
