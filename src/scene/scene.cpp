#include "pdx/scene/scene.hpp"

#include "grid_body.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/mesh/gmsh.hpp"
#include "pdx/scene/mixed_points.hpp"
#include "pdx/scene/particle_warnings.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/solid.hpp"
#include "pdx/scene/space_body.hpp"
#include "pdx/solve/stable_step.hpp"
#include "plane_scene.hpp"

#include <cmath>

namespace pdx::scene {
namespace {
template <int Dim>
StepLimits limits_of(std::span<const pd::Stencil<Dim>> stencils, const field::System& system,
                     const law::Regions* regions = nullptr)
{
  StepLimits limits{solve::stable_step(system).limit, 0.0};
  for (const auto& stencil : stencils) {
    const double papers = papers_step<Dim>(stencil, regions);
    limits.papers = limits.papers > 0.0 ? std::min(limits.papers, papers) : papers;
  }
  return limits;
}

class SolidScene final : public Scene {
public:
  SolidScene(MPI_Comm comm, options::SceneOptions given, const mesh::MeasuredCosts* costs)
      : options_(std::move(given)), mesh_options_(options_.mesh), plan_(judged(options_, mesh_options_)),
        mesh_(cut_mesh(comm, mesh_options_, cell_cost(plan_), costs)), swarm_(comm)
  {
    stop_if_told(comm);
    solid_ = discretise(comm, options_, plan_, make_particles(mesh_, plan_, swarm_));
    stop_if_told(comm);
  }
  Standing standing() override { return {&mesh_, solid_.get()}; }
  field::System& system() override { return solid_->system; }
  StepLimits limits() override { return limits_of<3>({&plan_.stencil, 1}, solid_->system, options_.regions.get()); }
  std::vector<std::string> warnings() override
  {
    return {correction_warning(options_, plan_.sides),
            thin_warning(options_, plan_.lattice.count, plan_.stencil, plan_.sides),
            region_warning(options_, mesh_, solid_->particles)};
  }

private:
  static SolidPlan judged(const options::SceneOptions& options, mesh::MeshOptions& mesh)
  {
    SolidPlan plan = plan_solid(options, mesh);
    require_rows(options, plan.lattice.count);
    return plan;
  }
  options::SceneOptions options_;
  mesh::MeshOptions mesh_options_;
  SolidPlan plan_;
  mesh::Mesh mesh_;
  pd::Particles swarm_;
  std::unique_ptr<Model> solid_;
};

template <int Dim> class CloudScene final : public Scene {
public:
  CloudScene(MPI_Comm comm, options::SceneOptions given, const CloudPlan<Dim>& plan, const mesh::MeasuredCosts* costs)
      : options_(std::move(given)), mesh_(cut_mesh(comm, plan.mesh, cell_cost(plan), costs)), swarm_(comm)
  {
    stop_if_told(comm);
    body_ = discretise(comm, options_, plan, make_particles(mesh_, plan, swarm_));
    stop_if_told(comm);
  }
  Standing standing() override { return {&mesh_, body_.get()}; }
  field::System& system() override { return body_->system; }
  StepLimits limits() override { return limits_of<Dim>({}, body_->system); }
  std::vector<std::string> warnings() override
  {
    return cloud_warnings(options_, static_cast<const CloudPart<Dim>&>(*body_->parts[0]));
  }

private:
  options::SceneOptions options_;
  mesh::Mesh mesh_;
  pd::Particles swarm_;
  std::unique_ptr<Model> body_;
};

template <int Dim> class PointScene final : public Scene {
public:
  PointScene(MPI_Comm comm, options::SceneOptions given, const PointPlan<Dim>& plan, const mesh::MeasuredCosts* costs)
      : options_(std::move(given)), mesh_(cut_mesh(comm, plan.mesh, {}, costs)),
        body_(discretise<Dim>(options_, plan, mesh_))
  {
    stop_if_told(comm);
  }
  Standing standing() override { return {&mesh_, body_.get()}; }
  field::System& system() override { return body_->system; }
  StepLimits limits() override { return limits_of<Dim>({}, body_->system); }

private:
  options::SceneOptions options_;
  mesh::Mesh mesh_;
  std::unique_ptr<Model> body_;
};

/// Material points in space, and particles in cells of theirs.
class SpaceScene final : public Scene {
public:
  SpaceScene(MPI_Comm comm, options::SceneOptions given, const SpaceBodies& bodies, const mesh::MeasuredCosts* costs)
      : options_(std::move(given)), bodies_(bodies), mesh_(cut_mesh(comm, bodies.points.mesh, {}, costs))
  {
    build();
  }
  Standing standing() override { return {&mesh_, body_.get()}; }
  field::System& system() override { return body_->system; }
  StepLimits limits() override { return limits_of<3>({&*bodies_.stencil, 1}, body_->system); }
  std::vector<std::string> warnings() override { return {correction_warning(options_, bodies_.sides)}; }
  const adapt::SpaceView* space() const override { return &*view_; }
  std::optional<Handed> change(const Layout& layout) override
  {
    view_.reset();
    body_.reset();
    options_ = layout.in(std::move(options_));
    build();
    return std::nullopt;
  }

private:
  void build()
  {
    body_ = discretise(options_, bodies_, mesh_);
    view_.emplace(body_->view());
    stop_if_told(mesh_.comm());
  }
  options::SceneOptions options_;
  const SpaceBodies& bodies_;
  mesh::Mesh mesh_;
  std::unique_ptr<SpaceModel> body_;
  std::optional<adapt::SpaceView> view_;
};

SceneMaker space_maker(MPI_Comm comm, options::SceneOptions& options)
{
  auto bodies = std::make_shared<SpaceBodies>(settle_in_space(options));
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank) *bodies->points.mesh.list = {}; // a mesh begins on one rank
  return [comm, &options, bodies](const Layout& layout, const mesh::MeasuredCosts* costs) -> std::unique_ptr<Scene> {
    return std::make_unique<SpaceScene>(comm, layout.in(options), *bodies, costs);
  };
}

template <int Dim> SceneMaker point_maker(MPI_Comm comm, options::SceneOptions& options)
{
  auto plan = std::make_shared<PointPlan<Dim>>(plan_points<Dim>(options, std::numeric_limits<double>::infinity()));
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank) *plan->mesh.list = {}; // a mesh begins on one rank
  return [comm, &options, plan](const Layout& layout, const mesh::MeasuredCosts* costs) -> std::unique_ptr<Scene> {
    return std::make_unique<PointScene<Dim>>(comm, layout.in(options), *plan, costs);
  };
}

/// The whole cloud is kept only where it is asked for again.
template <int Dim> SceneMaker cloud_maker(MPI_Comm comm, options::SceneOptions& options)
{
  auto plan = std::make_shared<CloudPlan<Dim>>(plan_cloud<Dim>(options));
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  const bool may_change = options.layout.may_change(ranks);
  return [comm, &options, plan, may_change](const Layout& layout,
                                            const mesh::MeasuredCosts* costs) mutable -> std::unique_ptr<Scene> {
    auto scene = std::make_unique<CloudScene<Dim>>(comm, layout.in(options), *plan, costs);
    if (!may_change) plan.reset();
    return scene;
  };
}

/// @param plan of bodies of material points beside, null for none
SceneMaker plane_maker(MPI_Comm comm, const options::SceneOptions& options, std::shared_ptr<const PointPlan<2>> plan)
{
  return [comm, &options, plan = std::move(plan)](const Layout& layout,
                                                  const mesh::MeasuredCosts* costs) -> std::unique_ptr<Scene> {
    return plane_scene(comm, layout.in(options), costs, plan);
  };
}

SceneMaker solid_maker(MPI_Comm comm, const options::SceneOptions& options)
{
  return [comm, &options](const Layout& layout, const mesh::MeasuredCosts* costs) -> std::unique_ptr<Scene> {
    return std::make_unique<SolidScene>(comm, layout.in(options), costs);
  };
}
} // namespace

SceneMaker scene_in_time(MPI_Comm comm, options::SceneOptions& options)
{
  const bool solid = options.solid;
  if (options.mixed()) return plane_maker(comm, options, settle_mixed(comm, options));
  if (options.mixed_in_space()) return space_maker(comm, options);
  if (options.points.any() && options.points.formulation == options::Formulation::updated)
    return grid_scene(comm, options);
  if (options.points.any()) return solid ? point_maker<3>(comm, options) : point_maker<2>(comm, options);
  if (!options.pd.cloud.empty()) return solid ? cloud_maker<3>(comm, options) : cloud_maker<2>(comm, options);
  return solid ? solid_maker(comm, options) : plane_maker(comm, options, nullptr);
}
} // namespace pdx::scene
