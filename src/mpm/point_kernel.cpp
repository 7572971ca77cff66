#include "pdx/mpm/point_kernel.hpp"

#include "cell_sweep.hpp"
#include "pdx/law/waves.hpp"

namespace pdx::mpm {
namespace {
template <int Dim, class Work> struct SweepRuns {
  const Work& work;
  const BodyMaterial& body;
  const CellPoints<Dim>& full;
  std::span<const CellRun<Dim>> runs;
  const NodeFields& fields;
  double& sum;

  template <int W> PDX_INLINE void run() const { body.ratio == 1 ? with_ratio<W, 1>() : with_ratio<W, 2>(); }

private:
  template <int W, int R> PDX_INLINE void with_ratio() const
  {
    RunSweep<W, Dim, R, Work> sweep{work, full, 1.0 / body.side(), fields};
    for (const CellRun<Dim>& cells : runs) sweep.along(cells);
    sum = sweep.sum * full.volume;
    if (fields.skipped) *fields.skipped += sweep.skipped;
  }
};

template <int Dim, class Work> struct SweepCells {
  const Work& work;
  const CellPoints<Dim>& points;
  std::span<const CellRows<Dim>> cells;
  const NodeFields& fields;
  double& sum;

  template <int W> PDX_INLINE void run() const
  {
    CellSweep<W, Dim, Work> sweep{work, points, fields};
    sweep.over(cells);
    sum = sweep.sum;
    if (fields.skipped) *fields.skipped += sweep.skipped;
  }
};

template <int Dim, class Work>
double sweep_runs(Processor processor, const Work& work, const BodyMaterial& body, const CellPoints<Dim>& full,
                  std::span<const CellRun<Dim>> runs, const NodeFields& fields)
{
  double sum = 0.0;
  run_on(processor, SweepRuns<Dim, Work>{work, body, full, runs, fields, sum});
  return sum;
}
template <int Dim, class Work>
double sweep_cells(Processor processor, const Work& work, const CellPoints<Dim>& points,
                   std::span<const CellRows<Dim>> cells, const NodeFields& fields)
{
  double sum = 0.0;
  run_on(processor, SweepCells<Dim, Work>{work, points, cells, fields, sum});
  return sum;
}

template <int Dim> ViscousForces<Dim> viscous(const BodyMaterial& body, double b)
{
  const law::Tangent<Dim> rest = law_tangent<Dim>(body, Tensor<Dim>::Zero());
  return {b * std::sqrt(body.elastic.density * rest(0, 0)) * body.side()};
}
} // namespace

template <int Dim>
void add_run_forces(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& full,
                    std::span<const CellRun<Dim>> runs, const NodeFields& fields)
{
  if (body.law == Law::corotational)
    sweep_runs(processor, ElasticForces<Dim, law::Corotational<Dim>>(body), body, full, runs, fields);
  else
    sweep_runs(processor, ElasticForces<Dim, law::NeoHooke<Dim>>(body), body, full, runs, fields);
}

template <int Dim>
void add_cell_forces(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& points,
                     std::span<const CellRows<Dim>> cells, const NodeFields& fields)
{
  if (body.law == Law::corotational)
    sweep_cells(processor, ElasticForces<Dim, law::Corotational<Dim>>(body), points, cells, fields);
  else
    sweep_cells(processor, ElasticForces<Dim, law::NeoHooke<Dim>>(body), points, cells, fields);
}

template <int Dim>
double cell_energy(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& points,
                   std::span<const CellRows<Dim>> cells, const double* u)
{
  NodeFields fields;
  fields.u = u;
  return body.law == Law::corotational
             ? sweep_cells(processor, ElasticEnergy<Dim, law::Corotational<Dim>>(body), points, cells, fields)
             : sweep_cells(processor, ElasticEnergy<Dim, law::NeoHooke<Dim>>(body), points, cells, fields);
}

template <int Dim>
double add_run_viscous(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& full, double b,
                       std::span<const CellRun<Dim>> runs, const NodeFields& fields)
{
  return sweep_runs(processor, viscous<Dim>(body, b), body, full, runs, fields);
}

template <int Dim>
double add_cell_viscous(Processor processor, const BodyMaterial& body, const CellPoints<Dim>& points, double b,
                        std::span<const CellRows<Dim>> cells, const NodeFields& fields)
{
  return sweep_cells(processor, viscous<Dim>(body, b), points, cells, fields);
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void add_run_forces<Dim>(Processor, const BodyMaterial&, const CellPoints<Dim>&,                            \
                                    std::span<const CellRun<Dim>>, const NodeFields&);                                 \
  template void add_cell_forces<Dim>(Processor, const BodyMaterial&, const CellPoints<Dim>&,                           \
                                     std::span<const CellRows<Dim>>, const NodeFields&);                               \
  template double cell_energy<Dim>(Processor, const BodyMaterial&, const CellPoints<Dim>&,                             \
                                   std::span<const CellRows<Dim>>, const double*);                                     \
  template double add_run_viscous<Dim>(Processor, const BodyMaterial&, const CellPoints<Dim>&, double,                 \
                                       std::span<const CellRun<Dim>>, const NodeFields&);                              \
  template double add_cell_viscous<Dim>(Processor, const BodyMaterial&, const CellPoints<Dim>&, double,                \
                                        std::span<const CellRows<Dim>>, const NodeFields&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
