#include "plane_scene.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/scene/kept.hpp"
#include "pdx/scene/mixed_points.hpp"
#include "pdx/scene/particle_warnings.hpp"
#include "pdx/scene/point_body.hpp"
#include "pdx/solve/stable_step.hpp"

#include <cmath>

namespace pdx::scene {
namespace {
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
  cover_cells(mesh, plan, mesh_options, options.frame, kept);
  particles = make_particles(mesh, plan, kept);
  stop_if_told(mesh.comm());
}

void Ground::lay_again(options::SceneOptions given, Kept* kept)
{
  options = std::move(given);
  mesh_options = options.mesh;
  plan = judged_plan(options, mesh_options, &plan);
  if (kept) {
    kept->match(plan);
    kept->uncover(mesh);
  } else
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
    const Index nodes_before = d_->system.rows.first_particle();
    d_.reset();
    ground_.lay_again(layout.in(ground_.options), kept ? &*kept : nullptr);
    build(kept ? &*kept : nullptr);
    const std::vector<double> before = std::exchange(least_, {});
    for (std::size_t p = 0; kept && p < ground_.plan.shapes.size(); ++p)
      least_.push_back(kept->has(p) ? before.at(kept->before(p)) : kUnknown);
    unknown_.reset();
    changing_.reset();
    if (!kept) return std::nullopt;
    leave_out(kept->same());
    unknown_ = kept->near(*d_, ground_.mesh);
    field::StayingRows front = kept->rows();
    front.before = nodes_before;
    front.now = d_->system.rows.first_particle();
    std::erase_if(front.runs, [&](const auto& run) { return run.from >= nodes_before; });
    front.carry(squares_, 1);
    if (kept->keeps_sets()) look_at(kept->touched(), kept->same());
    return kept->handed();
  }
  void foresee(const Layout& next) override
  {
    if (!hands_over(next)) return;
    const std::vector<couple::PatchShape> shapes = patch_shapes(next.in(ground_.options));
    const std::vector<bool> stay = Kept::staying(*d_, shapes);
    leave_out(stay);
    const std::vector<Index> touched = Kept::touched(*d_, ground_.mesh, shapes);
    if (any_rank(ground_.mesh.comm(), near_cracks(ground_.mesh, touched, d_->cracks))) return;
    look_at(touched, stay);
  }
  std::optional<std::vector<std::array<Index, 2>>> changing_rows() const override { return changing_; }
  void settle() override
  {
    leave_out({});
    changing_.reset();
    if (d_->elements) d_->elements->count_only(std::nullopt);
  }

private:
  static constexpr double kUnknown = -1.0;

  void leave_out(const std::vector<bool>& patches)
  {
    if (d_->bonds) d_->bonds->leave_out(patches);
    if (d_->carried) d_->carried->leave_out(patches);
  }

  /// Nodes of some cells and particles of patches that do not stay are all that is looked at.
  void look_at(const std::vector<Index>& cells, const std::vector<bool>& stay)
  {
    changing_ = ranges_of(near_rows(*d_, ground_.mesh, cells));
    for (std::size_t p = 0; p < stay.size(); ++p)
      if (const pd::LatticePart<2>& part = *d_->bonds->parts()[p]; !stay[p])
        changing_->push_back({part.first_row(), part.first_row() + static_cast<Index>(part.sites().size())});
    if (d_->elements) d_->elements->count_only(cells);
  }

  /// As `solve::stable_step` has it. What patches that stay allow is known.
  double rigorous_limit()
  {
    field::System& system = d_->system;
    const Index particles = system.rows.first_particle();
    least_.resize(ground_.plan.shapes.size(), kUnknown);
    squares_.resize(static_cast<std::size_t>(particles));
    if (!unknown_) unknown_ = {{0, system.rows.owned()}};
    const std::vector<double> squares = solve::row_limits(system, *unknown_);
    for (double& of_patch : least_)
      if (of_patch == kUnknown) of_patch = std::numeric_limits<double>::infinity();
    auto next = squares.begin();
    std::size_t patch = 0;
    for (const auto& [first, end] : *unknown_)
      for (Index row = first; row < end; ++row, ++next) {
        if (row < particles) {
          squares_[static_cast<std::size_t>(row)] = *next;
          continue;
        }
        while (patch + 1 < least_.size() && d_->bonds->parts()[patch + 1]->first_row() <= row) ++patch;
        least_[patch] = std::min(least_[patch], *next);
      }
    unknown_.emplace();
    double least = std::numeric_limits<double>::infinity();
    for (const double square : squares_) least = std::min(least, square);
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
  // As `solve::row_limits` has it: the least of each patch, of its particles here; of all other rows each [s^2].
  std::vector<double> least_, squares_;
  std::optional<std::vector<std::array<Index, 2>>> unknown_, changing_; // rows whose limit is unknown; see `foresee`
};
} // namespace

std::unique_ptr<Scene> plane_scene(MPI_Comm comm, options::SceneOptions options, const mesh::MeasuredCosts* costs,
                                   std::shared_ptr<const PointPlan<2>> points)
{
  return std::make_unique<PlaneScene>(comm, std::move(options), costs, std::move(points));
}
} // namespace pdx::scene
