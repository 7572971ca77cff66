#include "pdx/mpm/grid_kernel.hpp"

#include "grid_kernel_shapes.hpp"
#include "pdx/law/solid_law.hpp"

namespace pdx::mpm {
namespace {
constexpr double kNoMass = 1e-30;   // of a point's: a node that points do not see
constexpr double kSmallMass = 1e-6; // likewise: points see too little of it for the velocity that a force gives it
} // namespace

template <int Dim>
void give(Processor processor, const GridRule& rule, const BodyMaterial& body, const Giving& what,
          const Vector<Dim>& push, const PointLanes<Dim>& points, const NodeView<Dim>& nodes)
{
  if (rule.shape == Shape::hat)
    give_with<Dim, Hats>(processor, rule, body, what, push, points, nodes);
  else if (rule.shape == Shape::gimp)
    give_with<Dim, MeantHats>(processor, rule, body, what, push, points, nodes);
  else
    give_with<Dim, Splines>(processor, rule, body, what, push, points, nodes);
}

template <int Dim>
Vector<Dim> take(Processor processor, const GridRule& rule, const BodyMaterial& body, const Taking& what,
                 PointLanes<Dim>& points, const NodeView<Dim>& nodes)
{
  if (rule.shape == Shape::hat) return take_with<Dim, Hats>(processor, rule, body, what, points, nodes);
  if (rule.shape == Shape::gimp) return take_with<Dim, MeantHats>(processor, rule, body, what, points, nodes);
  return take_with<Dim, Splines>(processor, rule, body, what, points, nodes);
}

namespace {
/// Sums into what they mean, a node a lane. Lists are as long as whole vectors.
struct SettleNodes {
  std::span<const double> mass;
  double least, tiny, step; ///< masses that are none, or too small for a velocity to come from a force [kg]
  double* momentum;
  double* force; ///< null: there is none
  template <int W> PDX_INLINE void run() const
  {
    for (std::size_t k = 0; k < mass.size(); k += W) {
      const Lanes<W> m = load<W>(mass.data() + k);
      const Lanes<W> per = m > least ? 1.0 / m : Lanes<W>{};
      Lanes<W> v = momentum ? load<W>(momentum + k) : Lanes<W>{};
      if (momentum && !is_velocity) v *= per;
      if (force) {
        const Lanes<W> a = load<W>(force + k) * per;
        store<W>(a, force + k);
        v += m > tiny ? step * a : Lanes<W>{};
      }
      if (momentum) store<W>(v, momentum + k);
    }
  }
  bool is_velocity = false; ///< `momentum` has been one
};

template <int Dim, class Law> struct SumEnergies {
  const Law& law;
  const PointLanes<Dim>& points;
  PointEnergies& sums;
  template <int W> PDX_INLINE void run() const
  {
    constexpr int kLanes = PointLanes<Dim>::kLanes;
    for (const auto& block : points.blocks())
      for (int lane = 0; lane < kLanes; lane += W)
        for (int s = 0; s < block.slots; ++s) {
          const double* const numbers = points.slot(block, s) + lane;
          Lanes<W> h[Dim][Dim], square{};
          for (int d = 0; d < Dim; ++d) {
            const Lanes<W> v = load<W>(numbers + (Dim + d) * kLanes);
            square += v * v;
            for (int e = 0; e < Dim; ++e) h[d][e] = load<W>(numbers + (2 * Dim + Dim * d + e) * kLanes);
          }
          const Lanes<W> density = law.energy(h);
          for (int l = 0; l < W; ++l)
            if (block.counts[lane + l] > s) {
              sums.strain += density[l];
              sums.kinetic += square[l];
            }
        }
  }
};
} // namespace

void settle_nodes(Processor processor, std::span<const double> mass, double point, double step, double* momentum,
                  double* force, bool is_velocity, bool spare)
{
  run_on(processor, SettleNodes{mass, kNoMass * point, (spare ? kSmallMass : kNoMass) * point, step, momentum, force,
                                is_velocity});
}

template <int Dim>
PointEnergies energies_of(Processor processor, const BodyMaterial& body, const PointLanes<Dim>& points)
{
  PointEnergies sums;
  const double volume = point_volume<Dim>(body);
  if (body.law == Law::corotational) {
    const law::Corotational<Dim> law(body.elastic);
    run_on(processor, SumEnergies<Dim, law::Corotational<Dim>>{law, points, sums});
  } else {
    const law::NeoHooke<Dim> law(body.elastic);
    run_on(processor, SumEnergies<Dim, law::NeoHooke<Dim>>{law, points, sums});
  }
  return {volume * sums.strain, 0.5 * body.elastic.density * volume * sums.kinetic};
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void give<Dim>(Processor, const GridRule&, const BodyMaterial&, const Giving&, const Vector<Dim>&,          \
                          const PointLanes<Dim>&, const NodeView<Dim>&);                                               \
  template Vector<Dim> take<Dim>(Processor, const GridRule&, const BodyMaterial&, const Taking&, PointLanes<Dim>&,     \
                                 const NodeView<Dim>&);                                                                \
  template PointEnergies energies_of<Dim>(Processor, const BodyMaterial&, const PointLanes<Dim>&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
