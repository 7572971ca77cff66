#include "pdx/change/patch_mover.hpp"

#include "pdx/adapt/conversion.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/base/options.hpp"
#include "pdx/options/adapt_options.hpp"
#include "pdx/scene/layout.hpp"
#include "pdx/scene/model.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace pdx::change {
namespace {
constexpr int kLooksUntilQuiet = 8; // at what is quiet, in the steps after which it is handed back
constexpr double kAbove = 1.001;    // strength: at it bonds may as well break, rounding apart
constexpr double kConnected = 4.0 / 3.0, kDisconnected = 3.0; // horizons, with the trigger connection alone

/// At which bonds of what becomes particles break [-].
template <int Dim> double critical_stretch_of(const options::SceneOptions& options)
{
  const double dx = options.pd.spacing[0];
  const pd::Stencil<Dim> stencil =
      pd::make_stencil<Dim>({dx, options.elastic.thickness, options.pd.horizon_ratio * dx, options.pd.micromodulus,
                             options.pd.calibration, options.elastic});
  return scene::critical_stretch<Dim>(options, stencil);
}

/// What becomes particles above the strength of bonds breaks as soon as it does.
template <int Dim> std::string late_stress(const options::SceneOptions& options)
{
  const options::Triggers& triggers = options.layout.triggers;
  if (!triggers.stress || triggers.stretch || triggers.connection || triggers.damage) return "";
  const double critical = critical_stretch_of<Dim>(options);
  const double strength = options.elastic.principal_stress(critical, 0.0);
  if (triggers.largest_stress < kAbove * strength) return "";
  return fmt::format(
      "-adapt_stress is {:.4g} Pa, but bonds {:g} m apart break at {:.4g} Pa (a stretch of {:.4g}): what becomes "
      "particles breaks at once; give less, or -adapt_trigger stretch",
      triggers.largest_stress, options.pd.spacing[0], strength, critical);
}

void refuse_undivided(const adapt::UndividedCell& cell)
{
  const double fit = scene::nearest_fit({cell.sides.data(), 2}, cell.spacing);
  throw UserError(fmt::format(
      "-pd_spacing is {:g}: the sides {:.6g} and {:.6g} m of the cells that -adapt_trigger is to "
      "make particles must be whole numbers of it; {}",
      cell.spacing, cell.sides[0], cell.sides[1],
      fit > 0.0 ? fmt::format("the nearest that fits is {:.10g}", fit) : "no spacing fits both: change the cells"));
}

/// In space particles are where points were.
void refuse_unlike_spacing(const options::SceneOptions& options)
{
  const law::Elastic& e = options.elastic;
  for (const options::PointBodyOptions& body : options.points.bodies)
    if (body.spacing != options.pd.spacing[0] && body.elastic.young == e.young && body.elastic.poisson == e.poisson &&
        body.elastic.density == e.density)
      throw UserError(fmt::format("-pd_spacing is {:g}: with -material_plane solid it must be that of the points, {:g} "
                                  "for {}",
                                  options.pd.spacing[0], body.spacing, body.name));
}
} // namespace

adapt::Reaches PatchMover::reaches(const couple::Surroundings& around, double horizon) const
{
  const double element = around.shortest_edge();
  return {options::critical_length(options_, horizon, element), options::expansion_length(options_, horizon, element)};
}

std::vector<adapt::Reaches> PatchMover::reaches(const adapt::SceneView& scene, const scene::PatchPlan& plan) const
{
  std::vector<adapt::Reaches> all;
  for (std::size_t p = 0; p < scene.around.size(); ++p)
    all.push_back(reaches(scene.around[p], plan.stencils[p].horizon));
  return all;
}

std::string PatchMover::begin(const adapt::SceneView& scene, const scene::PatchPlan& plan) const
{
  for (const auto& [critical, expansion] : reaches(scene, plan))
    if (expansion <= critical && std::isfinite(critical))
      throw UserError(
          fmt::format("-adapt_expansion_length is {:g}: must be above the {:g} of -adapt_critical_length, or "
                      "patches never move away from what broke",
                      expansion, critical));
  if (const auto lattices = scene::body_lattices(options_);
      options_.converts() && !adapt::can_convert(scene, lattices)) {
    const auto cell = adapt::undivided_cell(scene, lattices);
    if (cell && scene.around.empty()) refuse_undivided(*cell);
    return "-adapt_trigger: no cell can become particles: their sides must be whole numbers of -pd_spacing, and points "
           "full, of -material_young, _poisson and _density";
  }
  if (options_.converts()) return late_stress<2>(options_);
  if (adapt::can_expand(scene)) return "";
  return "-adapt: the sides of no element are whole numbers of -pd_spacing on its lines, so no patch will grow";
}

adapt::LayoutChange PatchMover::renewal(const adapt::SceneView& scene) const
{
  return adapt::exchanged(scene, *options_.layout.renew_box, options_.time.dynamic());
}

bool PatchMover::broke_more(MPI_Comm comm, std::int64_t broken)
{
  return any_rank(comm, std::exchange(broken_, broken) != broken);
}

bool PatchMover::watches() const
{
  const options::SceneOptions& s = options_;
  return !told_ && !s.solid && !s.layout.patches_move() && s.fracture.active() && s.pd.bordered();
}

std::string PatchMover::border(const adapt::SceneView& scene, const scene::PatchPlan& plan, std::int64_t broken)
{
  static Event event("border_look");
  if (!broke_more(scene.mesh.comm(), broken)) return "";
  const Timed timed(event);
  std::vector<adapt::Reaches> horizons;
  for (const pd::Stencil<2>& stencil : plan.stencils) horizons.push_back({stencil.horizon, 0.0});
  const std::optional<Vector<2>> at = adapt::broken_at_border(scene, horizons);
  if (!at) return "";
  told_ = true;
  const std::string words = fmt::format(
      "a crack came to {}, within a horizon of the elements around its patch, which do not break: it is held "
      "back there; give larger -pd_patches, or -adapt expand",
      options_.frame.text(*at));
  if (options_.layout.stops_at_border) throw SolverFailure(words);
  return words;
}

template <int Dim> adapt::ConversionRule PatchMover::conversion_rule() const
{
  const options::Triggers& triggers = options_.layout.triggers;
  const double critical = critical_stretch_of<Dim>(options_);
  adapt::ConversionRule rule;
  rule.margin = triggers.margin;
  if (triggers.stress) rule.stress = triggers.largest_stress;
  if (triggers.connection) rule.stretch = critical;
  if (triggers.stretch) rule.stretch = triggers.stretch_share * critical;
  if (triggers.connection && triggers.stretch) rule.stretch = std::min(critical, triggers.stretch_share * critical);
  return rule;
}

adapt::BulkWatch PatchMover::bulk_watch(const adapt::SceneView& scene) const
{
  const auto& bodies = options_.points.bodies;
  const auto elastic = [&](Index body) -> const law::Elastic& {
    const auto b = static_cast<std::size_t>(body);
    return b < bodies.size() ? bodies[b].elastic : options_.elastic;
  };
  return {scene, conversion_rule<2>(), elastic};
}

std::vector<adapt::LayoutChange::Cover> PatchMover::converted(const adapt::SceneView& scene,
                                                              std::span<const double> local)
{
  static Event event("adapt_convert");
  const Timed timed(event);
  if (!watch_) {
    watch_.emplace(bulk_watch(scene));
    lattices_ = scene::body_lattices(options_);
  }
  return adapt::conversion(scene, *watch_, lattices_, local);
}

namespace {
/// Both, each cell once: cells are told by their boxes, to the last bit.
void join(std::vector<adapt::LayoutChange::Cover>& covers, const std::vector<adapt::LayoutChange::Cover>& more)
{
  for (const adapt::LayoutChange::Cover& cover : more)
    if (std::ranges::none_of(covers, [&cover](const auto& known) {
          return known.body == cover.body && known.box.lower == cover.box.lower && known.box.upper == cover.box.upper;
        }))
      covers.push_back(cover);
}
} // namespace

adapt::LayoutChange PatchMover::look(const adapt::SceneView& scene, const scene::PatchPlan& plan, std::int64_t broken,
                                     std::span<const double> local)
{
  static Event event("adapt_look");
  adapt::LayoutChange change;
  const options::Triggers& triggers = options_.layout.triggers;
  if ((triggers.damage || triggers.connection) && broke_more(scene.mesh.comm(), broken)) {
    const Timed timed(event);
    std::vector<adapt::Reaches> reach = reaches(scene, plan);
    for (std::size_t p = 0; p < reach.size() && !triggers.damage; ++p) // bonds of bulk are as long as a horizon
      reach[p] = {kConnected * plan.stencils[p].horizon, kDisconnected * plan.stencils[p].horizon};
    change.cover = adapt::expansion(scene, reach, seen_.news(scene), options_.time.dynamic());
  }
  if (options_.layout.triggers.any()) join(change.cover, converted(scene, local));
  if (!change.cover.empty()) ++expansions_;
  return change;
}

std::string PatchMover::begin(const adapt::SpaceView& scene) const
{
  bool any = false;
  for (const mpm::GridCell<3>& cell : scene.cells) any = any || scene.may_convert(cell);
  if (any_rank(scene.halo.rows().comm, any)) return late_stress<3>(options_);
  if (scene.shapes.empty()) refuse_unlike_spacing(options_);
  return "-adapt: no cell of points can become particles: they must be full of points, -pd_spacing apart, of "
         "-material_young, _poisson and _density, and not held at a side";
}

/// Beside what broke, and where points bear more than the triggers say.
adapt::LayoutChange PatchMover::look(const adapt::SpaceView& scene, std::int64_t broken, std::span<const double> local)
{
  static Event event("adapt_look");
  const options::Triggers& triggers = options_.layout.triggers;
  adapt::SpaceCells asked, born;
  if ((triggers.damage || triggers.connection) && broke_more(scene.halo.rows().comm, broken)) {
    const Timed timed(event);
    const double horizon = options_.pd.horizon_ratio * options_.pd.spacing[0];
    adapt::Reaches reach{kConnected * horizon, kDisconnected * horizon};
    if (const double h = options_.points.ratio * options_.pd.spacing[0]; triggers.damage)
      reach = {options::critical_length(options_, horizon, h), options::expansion_length(options_, horizon, h)};
    asked = adapt::expansion(scene, reach);
  }
  if (triggers.any()) {
    static Event converts("adapt_convert");
    const Timed timed(converts);
    if (!space_watch_) space_watch_.emplace(scene, conversion_rule<3>());
    born = adapt::conversion(scene, *space_watch_, local);
  }
  adapt::LayoutChange change;
  std::ranges::set_union(asked, born, std::back_inserter(change.cells));
  return change;
}

int PatchMover::quiet_every() const { return std::max(1, options_.layout.hand_back / kLooksUntilQuiet); }

adapt::LayoutChange PatchMover::quiet(const adapt::SceneView& scene, std::span<const double> local)
{
  static Event event("adapt_hand_back");
  const Timed timed(event);
  adapt::LayoutChange change;
  const int looks = (options_.layout.hand_back + quiet_every() - 1) / quiet_every();
  change.uncover = quiet_.look(scene, {conversion_rule<2>(), looks, options_.elastic}, options_.pd.patches, local);
  return change;
}

adapt::LayoutChange PatchMover::contract(const adapt::SceneView& scene, const scene::PatchPlan& plan,
                                         const adapt::MayHandBack& may)
{
  static Event event("adapt_contract");
  const Timed timed(event);
  expansions_ = 0;
  std::vector<adapt::Retreat> all;
  const std::vector<adapt::Reaches> ahead = reaches(scene, plan);
  for (std::size_t p = 0; p < scene.around.size(); ++p)
    all.push_back({ahead[p].critical,
                   options::contraction_length(options_, plan.stencils[p].horizon, scene.around[p].shortest_edge()),
                   options_.layout.tracker});
  return adapt::contraction(scene, all, may);
}
} // namespace pdx::change
