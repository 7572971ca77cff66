#include "pdx/scene/scene.hpp"

#include "grid_body.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/mesh/gmsh.hpp"
#include "pdx/scene/kept.hpp"
#include "pdx/scene/mixed_points.hpp"
#include "pdx/scene/particle_warnings.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/scene/solid.hpp"
#include "pdx/scene/space_body.hpp"
#include "pdx/solve/stable_step.hpp"

#include <cmath>

namespace pdx::scene {
namespace {
/// The papers' step of the material with the least.
template <int Dim> double papers_step(const pd::Stencil<Dim>& stencil, const law::Regions* regions)
{
  double least = 1.0;
  for (std::size_t k = 1; regions && k < regions->count(); ++k)
    least = std::min(least,
                     std::sqrt(regions->elastic(k).density / regions->elastic(0).density / regions->stiffness(k, k)));
  return least * pd::papers_step(stencil);
}

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

mesh::Mesh cut_mesh(MPI_Comm comm, const mesh::MeshOptions& options, const mesh::CellCost& cost,
                    const mesh::MeasuredCosts* costs)
{
  return costs ? mesh::build_by_costs(comm, options, *costs) : mesh::build(comm, options, cost);
}

/// Refuses what cannot be before a mesh is paid for.
PatchPlan judged_plan(const options::SceneOptions& options, mesh::MeshOptions& mesh, const PatchPlan* known = nullptr)
{
  PatchPlan plan = plan_patches(options, mesh, known);
  if (options.pd.everywhere) require_rows(options, plan.shapes[0].lattice.count);
  return plan;
}
} // namespace

Ground::Ground(MPI_Comm comm, options::SceneOptions given, const mesh::MeasuredCosts* costs,
               std::shared_ptr<const PointPlan<2>> bodies)
    : options(std::move(given)), mesh_options(options.mesh), plan(judged_plan(options, mesh_options)),
      mesh(cut_mesh(comm, mesh_options, cell_cost(plan), costs)), areas(mesh), points(std::move(bodies))
{
  if (points) deal_cells(*points, mesh);
  stop_if_told(comm);
}

void Ground::lay_particles(Kept* kept)
{
  if (!options.pd.any()) return;
  cover_cells(mesh, plan, mesh_options, options.frame);
  particles = make_particles(mesh, plan, kept);
  stop_if_told(mesh.comm());
}

void Ground::lay_again(options::SceneOptions given, Kept* kept)
{
  options = std::move(given);
  mesh_options = options.mesh;
  plan = judged_plan(options, mesh_options, &plan);
  if (kept) kept->match(plan);
  mesh.uncover();
  lay_particles(kept);
}

std::vector<std::string> Ground::warnings() const
{
  std::vector<std::string> all{correction_warning(options, plan)};
  if (options.pd.everywhere) all.push_back(thin_warning(options, plan));
  if (options.pd.any() && !options.layout.patches_move())
    all.push_back(corner_warning(plan, mesh.bounds(), options.frame));
  return all;
}

namespace {
class PlaneScene final : public Scene {
public:
  PlaneScene(MPI_Comm comm, options::SceneOptions options, const mesh::MeasuredCosts* costs,
             std::shared_ptr<const PointPlan<2>> points)
      : ground_(comm, std::move(options), costs, std::move(points))
  {
    ground_.lay_particles();
    build();
  }
  Standing standing() override { return {&ground_.mesh, d_.get()}; }
  field::System& system() override { return d_->system; }
  StepLimits limits() override
  {
    StepLimits limits{rigorous_limit(), 0.0};
    for (const auto& stencil : ground_.plan.stencils) {
      const double papers = papers_step<2>(stencil, ground_.options.regions.get());
      limits.papers = limits.papers > 0.0 ? std::min(limits.papers, papers) : papers;
    }
    return limits;
  }
  std::vector<std::string> warnings() override
  {
    std::vector<std::string> all = ground_.warnings();
    all.push_back(region_warning(ground_.options, ground_.mesh, d_->particles));
    return all;
  }
  adapt::SceneView view() const override { return d_->view(ground_.mesh); }
  const PatchPlan& patches() const override { return ground_.plan; }
  bool hands_over(const Layout& layout) const override
  {
    return layout.cracks == ground_.options.cracks.lines && Kept::may_stay(*d_, ground_.options);
  }
  std::optional<Handed> change(const Layout& layout) override
  {
    std::optional<Kept> kept;
    if (hands_over(layout)) kept = Kept::of(*d_, ground_.mesh, ground_.options);
    d_.reset();
    ground_.lay_again(layout.in(ground_.options), kept ? &*kept : nullptr);
    build(kept ? &*kept : nullptr);
    const std::vector<double> before = std::exchange(least_, {});
    for (std::size_t p = 0; kept && p < ground_.plan.shapes.size(); ++p)
      least_.push_back(kept->has(p) ? before.at(kept->before(p)) : kUnknown);
    if (!kept) return std::nullopt;
    leave_out(kept->same());
    return kept->handed();
  }
  void foresee(const Layout& next) override
  {
    if (next.cracks == ground_.options.cracks.lines)
      leave_out(Kept::staying(*d_, ground_.options, patch_shapes(next.in(ground_.options))));
  }
  void settle() override { leave_out({}); }

private:
  static constexpr double kUnknown = -1.0;

  void leave_out(const std::vector<bool>& patches)
  {
    if (d_->bonds) d_->bonds->leave_out(patches);
    if (d_->carried) d_->carried->leave_out(patches);
  }

  /// As `solve::stable_step` has it. What patches that stay allow is known.
  double rigorous_limit()
  {
    field::System& system = d_->system;
    least_.resize(ground_.plan.shapes.size(), kUnknown);
    std::vector<std::array<Index, 2>> wanted{{0, system.rows.first_particle()}};
    std::vector<std::size_t> patches; // whose particles are wanted too
    for (std::size_t p = 0; p < least_.size(); ++p)
      if (const pd::LatticePart<2>& part = *d_->bonds->parts()[p]; least_[p] == kUnknown) {
        wanted.push_back({part.first_row(), part.first_row() + static_cast<Index>(part.sites().size())});
        patches.push_back(p);
      }
    const std::vector<double> squares = solve::row_limits(system, wanted);
    auto next = squares.begin() + wanted[0][1];
    double least = std::numeric_limits<double>::infinity();
    for (auto at = squares.begin(); at != next; ++at) least = std::min(least, *at);
    for (const std::size_t p : patches) {
      const auto end = next + std::ssize(d_->bonds->parts()[p]->sites());
      least_[p] = next == end ? std::numeric_limits<double>::infinity() : *std::min_element(next, end);
      next = end;
    }
    for (const double of_patch : least_) least = std::min(least, of_patch);
    MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_DOUBLE, MPI_MIN, system.rows.comm);
    return least > 0.0 ? 2.0 * std::sqrt(least) : solve::stable_step(system).limit; // says where there is no mass
  }

  void build(Kept* kept = nullptr)
  {
    const bool assembled = ground_.options.time.analysis == options::Analysis::implicit_dynamics;
    d_ = discretise(ground_.mesh, ground_.options, ground_.plan, std::move(ground_.particles), assembled,
                    ground_.points.get(), &ground_.areas, kept);
    stop_if_told(ground_.mesh.comm());
  }

  Ground ground_;
  std::unique_ptr<Discretisation> d_;
  std::vector<double> least_; // per patch, of its particles here: as `solve::row_limits` has it [s^2]
};

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
    return {thin_warning(options_, plan_.lattice.count), region_warning(options_, mesh_, solid_->particles)};
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
    return std::make_unique<PlaneScene>(comm, layout.in(options), costs, plan);
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
