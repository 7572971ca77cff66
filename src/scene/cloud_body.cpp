#include "pdx/scene/cloud_body.hpp"

#include "pdx/base/fingerprint.hpp"
#include "pdx/scene/settle.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::scene {
namespace {
constexpr double kCoarseCells = 4.0; // background cells, in particles
constexpr double kMostSpread = 1e12; // volumes over the smallest; coordinates over particle sizes
constexpr double kMostVolume = 1e60; // [m^3]

/// Double precision must tell places apart, and stiffnesses must be numbers.
template <int Dim> void judge_extent(const pd::Cloud<Dim>& cloud, double thickness)
{
  const auto [least, most] = std::ranges::minmax(cloud.volumes);
  if (!(most / least < kMostSpread) || !(most < kMostVolume) || !(least > 1.0 / kMostVolume))
    throw UserError(fmt::format("-pd_cloud: volumes from {:g} to {:g} m^3 are too far apart, too small or too large "
                                "(at most {:g} times the smallest)",
                                least, most, kMostSpread));
  const double size = pd::particle_size<Dim>(least, thickness);
  for (std::size_t k = 0; k < cloud.points.size(); ++k)
    if (!(cloud.points[k].cwiseAbs().maxCoeff() < kMostSpread * size))
      throw UserError(fmt::format(
          "-pd_cloud: particle {} is at ({:g}), too far out for its neighbours to be told apart "
          "(at most {:g} particle sizes, {:g} m)",
          k + 1, fmt::join(cloud.points[k].begin(), cloud.points[k].end(), ", "), kMostSpread, kMostSpread * size));
}

template <int Dim> geom::Frame frame_of(const pd::Cloud<Dim>& cloud)
{
  geom::Box<3> box;
  box.lower.template head<Dim>() = box.upper.template head<Dim>() = cloud.points[0];
  for (const Vector<Dim>& x : cloud.points) {
    box.lower.template head<Dim>() = box.lower.template head<Dim>().cwiseMin(x).eval();
    box.upper.template head<Dim>() = box.upper.template head<Dim>().cwiseMax(x).eval();
  }
  return geom::Frame(box);
}

template <int Dim> mesh::MeshOptions cells_around(const pd::Cloud<Dim>& cloud, double thickness)
{
  mesh::MeshOptions mesh;
  mesh.box = {cloud.points[0].template head<2>(), cloud.points[0].template head<2>()};
  double size = 0.0;
  for (std::size_t k = 0; k < cloud.points.size(); ++k) {
    const Vector<2> x = cloud.points[k].template head<2>();
    mesh.box.lower = mesh.box.lower.cwiseMin(x).eval();
    mesh.box.upper = mesh.box.upper.cwiseMax(x).eval();
    size += pd::particle_size<Dim>(cloud.volumes[k], thickness);
  }
  const auto count = static_cast<double>(cloud.points.size());
  size /= count;
  mesh.box.lower.array() -= 0.5 * size;
  mesh.box.upper.array() += 0.5 * size;
  // No more cells than particles, however thinly these are strewn.
  const double width = std::max(kCoarseCells * size, std::sqrt(mesh.box.size().prod() / count));
  for (std::size_t d = 0; d < 2; ++d)
    mesh.cells[d] =
        static_cast<Index>(std::clamp(std::round(mesh.box.size()[static_cast<Eigen::Index>(d)] / width), 1.0, count));
  return mesh;
}
} // namespace

template <int Dim> Index CloudPlan<Dim>::cell_at(const Vector<2>& x) const
{
  Site<2> at{};
  for (std::size_t d = 0; d < 2; ++d) {
    const auto a = static_cast<Eigen::Index>(d);
    const double share = (x[a] - mesh.box.lower[a]) / mesh.box.size()[a];
    at[d] = static_cast<Index>(std::clamp(std::floor(share * mesh.cells[d]), 0.0, mesh.cells[d] - 1.0));
  }
  return at[0] + mesh.cells[0] * at[1];
}

template <int Dim> CloudPlan<Dim> plan_cloud(options::SceneOptions& options)
{
  CloudPlan<Dim> plan;
  try {
    plan.particles = pd::read_cloud<Dim>(options.pd.cloud);
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-pd_cloud: {}", wrong.what()));
  }
  judge_extent<Dim>(plan.particles, options.elastic.thickness);
  const geom::Frame frame = frame_of<Dim>(plan.particles);
  const double least = *std::ranges::min_element(plan.particles.volumes);
  move_into(frame, pd::particle_size<Dim>(least, options.elastic.thickness), options);
  for (Vector<Dim>& x : plan.particles.points) x = frame.inside(x);
  plan.mesh = cells_around<Dim>(plan.particles, options.elastic.thickness);
  plan.counts.assign(static_cast<std::size_t>(plan.mesh.cells[0]) * static_cast<std::size_t>(plan.mesh.cells[1]), 0);
  Fingerprint fingerprint;
  for (const Vector<Dim>& x : plan.particles.points) {
    ++plan.counts[static_cast<std::size_t>(plan.cell_at(x.template head<2>()))];
    fingerprint.add(std::span<const double>(x.data(), Dim));
  }
  fingerprint.add(std::span<const double>(plan.particles.volumes));
  fingerprint.add(std::span<const Index>(plan.particles.sets));
  plan.fingerprint = fmt::format("{:016x}", fingerprint.value());
  return plan;
}

template <int Dim> mesh::CellCost cell_cost(const CloudPlan<Dim>& plan)
{
  return [&plan](const std::array<Vector<2>, 4>& corners) {
    const Vector<2> centre = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    return std::max(1, plan.counts[static_cast<std::size_t>(plan.cell_at(centre))]);
  };
}

template <int Dim>
std::vector<pd::Particle> make_particles(const mesh::Mesh& mesh, const CloudPlan<Dim>& plan, pd::Particles& swarm)
{
  std::vector<Index> local(plan.counts.size(), -1);
  for (Index c = 0; c < mesh.owned_cells(); ++c) local[static_cast<std::size_t>(plan.cell_at(mesh.centroid(c)))] = c;
  std::vector<pd::Particle> mine;
  for (std::size_t k = 0; k < plan.particles.points.size(); ++k) {
    const Vector<2> x = plan.particles.points[k].template head<2>();
    if (const Index cell = local[static_cast<std::size_t>(plan.cell_at(x))]; cell >= 0)
      mine.push_back({0, static_cast<Index>(k), cell, x});
  }
  auto total = static_cast<std::int64_t>(mine.size());
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, mesh.comm());
  if (total != static_cast<std::int64_t>(plan.particles.points.size()))
    throw std::logic_error(
        fmt::format("{} particles found a cell, {} should have", total, plan.particles.points.size()));
  swarm.add(mine);
  return swarm.sorted();
}

namespace {
template <int Dim> void number_rows(MPI_Comm comm, const pd::Cloud<Dim>& cloud, Model& body)
{
  body.system.rows = field::Rows::number(comm, Dim, 0, 0, static_cast<Index>(body.particles.size()));
  for (const pd::Particle& particle : body.particles) {
    const auto k = static_cast<std::size_t>(particle.site);
    body.system.coordinates.insert(body.system.coordinates.end(), cloud.points[k].begin(), cloud.points[k].end());
  }
}

template <int Dim>
pd::CloudTerm<Dim>& add_bonds(const options::SceneOptions& options, const pd::Cloud<Dim>& cloud, Model& body)
{
  const options::PdOptions& pd = options.pd;
  std::vector<Index> mine;
  for (const pd::Particle& particle : body.particles) mine.push_back(particle.site);
  try {
    body.system.terms.push_back(std::make_unique<pd::CloudTerm<Dim>>(
        body.system.rows, cloud, mine,
        pd::CloudOptions{pd.horizon, options.elastic.thickness, pd.micromodulus, options.elastic},
        options.bond_kinematics()));
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("-pd_cloud: {}", wrong.what()));
  }
  auto& bonds = static_cast<pd::CloudTerm<Dim>&>(*body.system.terms.back());
  if (!body.cracks.empty()) bonds.cut(body.cracks);
  return bonds;
}

template <int Dim> void add_fracture(const options::SceneOptions& options, pd::CloudTerm<Dim>& bonds, Model& body)
{
  const options::FractureOptions& f = options.fracture;
  if (!f.active()) return;
  const law::BondLaw<Dim> law(options.pd.micromodulus, options.elastic, options.pd.horizon);
  body.critical_stretch = {f.critical_stretch ? *f.critical_stretch : law.critical_stretch(*f.toughness)};
  auto breaker = std::make_unique<couple::CloudBreaker<Dim>>(bonds, body.critical_stretch[0], f.no_fail);
  body.breaker = breaker.get();
  body.system.after_step.push_back(std::move(breaker));
}
} // namespace

template <int Dim>
std::unique_ptr<Model> discretise(MPI_Comm comm, const options::SceneOptions& options, const CloudPlan<Dim>& plan,
                                  std::vector<pd::Particle> particles)
{
  auto body = std::make_unique<Model>();
  body->particles = std::move(particles);
  body->body = plan.mesh.box;
  judge_no_fail(options, body->body);
  body->cracks = cracks_in(options, body->body);
  number_rows<Dim>(comm, plan.particles, *body);
  pd::CloudTerm<Dim>& bonds = add_bonds<Dim>(options, plan.particles, *body);
  std::vector<Index> sets;
  for (const pd::Particle& particle : body->particles)
    sets.push_back(plan.particles.sets[static_cast<std::size_t>(particle.site)]);
  body->parts.push_back(std::make_unique<CloudPart<Dim>>(
      *body, bonds,
      fmt::format("{} particles {}, horizon {} m", plan.particles.points.size(), plan.fingerprint, options.pd.horizon),
      std::move(sets)));
  apply_conditions<Dim>(options, plan.particles, bonds, *body);
  body->system.bind();
  add_fracture<Dim>(options, bonds, *body);
  return body;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template struct CloudPlan<Dim>;                                                                                      \
  template CloudPlan<Dim> plan_cloud<Dim>(options::SceneOptions&);                                                     \
  template mesh::CellCost cell_cost<Dim>(const CloudPlan<Dim>&);                                                       \
  template std::vector<pd::Particle> make_particles<Dim>(const mesh::Mesh&, const CloudPlan<Dim>&, pd::Particles&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
template std::unique_ptr<Model> discretise<2>(MPI_Comm, const options::SceneOptions&, const CloudPlan<2>&,
                                              std::vector<pd::Particle>);
template std::unique_ptr<Model> discretise<3>(MPI_Comm, const options::SceneOptions&, const CloudPlan<3>&,
                                              std::vector<pd::Particle>);
} // namespace pdx::scene
