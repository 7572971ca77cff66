#include "pdx/record/run_files.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/base/given_options.hpp"
#include "pdx/base/machine_failure.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/earlier_files.hpp"
#include "pdx/io/provenance.hpp"
#include "pdx/io/vtkhdf.hpp"
#include "pdx/record/last_words.hpp"
#include "pdx/record/run_record.hpp"
#include "pdx/scene/seeds.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <utility>

namespace pdx::record {
namespace {
/// A run must not write over what it reads; a checkpoint is read before it is written.
void refuse_own_inputs(const std::string& directory)
{
  for (const auto& [name, option] : given_options())
    if ((name == "-pd_cloud" || name.ends_with("_file")) && io::is_output_of(option.value, directory))
      throw UserError(
          fmt::format("{} is {}: a run with -output_dir {} writes a file of that name: give another directory", name,
                      shown_path(option.value), shown_path(directory)));
}
} // namespace

RunFiles::RunFiles(MPI_Comm comm, const options::SceneOptions& given, double begin)
    : options(given), progress(comm, given.output.quiet), comm_(comm), begin_(begin),
      probes_(given.probes, given.output.directory,
              given.time.dynamic() ? io::Column{"time", "s"} : io::Column{"load", "-"})
{
  summary.case_name = options.case_name;
  summary.hosts = io::host_count(comm);
  io::create_directory(comm, options.output.directory);
  lock_ = std::make_unique<io::RunLock>(comm, options.output.directory);
  const std::filesystem::path place = options.output.directory;
  refuse_own_inputs(options.output.dry_run ? place.parent_path().string() : place.string());
}

void RunFiles::take_scene(const scene::Standing& standing)
{
  scene = standing;
  probes_.forget_hosts();
  const field::Rows& rows = scene.model->system.rows;
  std::int64_t counts[4] = {rows.nodes, rows.enriched, rows.particles, 0};
  for (std::int64_t& count : counts) count *= rows.dim;
  for (const mesh::Use use : {mesh::Use::plain, mesh::Use::cut})
    counts[3] +=
        std::ranges::count_if(scene.mesh->cells(use), [this](Index c) { return c < scene.mesh->owned_cells(); });
  MPI_Allreduce(MPI_IN_PLACE, counts, 4, MPI_INT64_T, MPI_SUM, comm_);
  elements_ = counts[3];
  summary.unknowns.fe = counts[0];
  summary.unknowns.enriched = counts[1];
  summary.unknowns.pd = counts[2];
  summary.unknowns.ghost = scene.model->ghosts;
  summary.unknowns.mpm = scene.model->material_points;
  if (const xfem::CutReport* report = scene.model->cut) {
    auto& results = summary.results;
    results["cut_elements"] = report->cells;
    results["enriched_sets"] = report->sets;
    results["enriched_sets_dropped"] = report->dropped;
  }
  summary.partition.cut = scene.mesh->quality().cut;
  summary.partition.imbalance = scene.mesh->quality().imbalance;
  summary.partition.particles_per_rank = gather_all(comm_, std::vector<int>{rows.particles});
}

void RunFiles::built(const scene::Standing& standing)
{
  take_scene(standing);
  for (const std::string& line : std::exchange(waiting_, {})) warn(line);
  const auto& unknowns = summary.unknowns;
  const auto elements = unknowns.fe + unknowns.enriched;
  const std::string grids = fmt::format("the grids of {} material points", unknowns.mpm);
  const bool points = scene.model->has_points();
  const std::string whose = scene.model->has_others() ? fmt::format("{} of elements{}, {} of particles", elements,
                                                                    points ? " and " + grids : "", unknowns.pd)
                                                      : "of " + grids;
  progress.line(fmt::format("{}: {} unknowns ({}), partition cut {} imbalance {:.2f}", options.case_name,
                            elements + unknowns.pd, whose, scene.mesh->quality().cut, scene.mesh->quality().imbalance));
  for (const auto& part : scene.model->parts) {
    if (const std::string counted = part->counted(options); !counted.empty()) progress.line(counted);
    warn(part->warning(options));
  }
  report_cracks();
  if (options.pd.seeded) summary.results["seeded_patches"] = scene::given_boxes(options);
}

void RunFiles::add_layout_columns(std::vector<io::Column>& columns) const
{
  if (options.layout.patches_move())
    columns.insert(columns.end(),
                   {{"particles", "-"}, {"elements", "-"}, {"relocations", "-"}, {"energy_relocated", "J"}});
}

void RunFiles::add_layout_row(std::vector<double>& row, double converted) const
{
  if (options.layout.patches_move())
    row.insert(row.end(), {static_cast<double>(summary.unknowns.pd) / scene.model->system.rows.dim,
                           static_cast<double>(elements_), static_cast<double>(summary.relocations), converted});
}

void RunFiles::add_layout_results(double converted, double work)
{
  const auto ranks = static_cast<int>(summary.partition.particles_per_rank.size());
  if (!options.layout.may_change(ranks)) return;
  summary.results["energy_converted"] = converted;
  if (options.layout.patches_move() && work > 0.0) summary.results["energy_relocated_ratio"] = converted / work;
  summary.results["layout_seconds"] = layout_seconds;
}

void RunFiles::report_cracks()
{
  if (!scene.model->cut) return;
  const xfem::CutReport& report = *scene.model->cut;
  if (report.dropped > 0)
    progress.line(fmt::format("{} nodes of cut elements have no enriched row: less than {:g} of their support lies on "
                              "one side",
                              report.dropped, options.cracks.rule.share()));
  for (const Vector<2>& tip : report.closed)
    warn(fmt::format("the crack tip at {} ends in elements and closes at the last element edge before it: put a patch "
                     "there for a true tip (-adapt_seed tip does)",
                     options.frame.text(tip)));
}

void RunFiles::make_room()
{
  if (std::exchange(room_made_, true)) return;
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (rank) return;
  const auto gone = io::clear_earlier_files(options.output.directory, continued.here);
  if (!gone.empty() && !continued.here)
    progress.line(fmt::format("of an earlier run in {}, gone: {}{}", options.output.directory, fmt::join(gone, ", "),
                              gone.back() == "checkpoint.h5" ? " (now checkpoint_before.h5)" : ""));
}

void RunFiles::started()
{
  make_room();
  if (!columns_.empty())
    history =
        std::make_unique<io::Curve>(comm_, std::filesystem::path(options.output.directory) / "history.csv", columns_,
                                    continued.here ? std::optional<double>(continued.step) : std::nullopt);
  if (options.output.fields) {
    const int kept = continued.here ? continued.fields : 0;
    fields = std::make_unique<io::FieldsFile>(comm_, options.output.directory, kept);
    if (kept && fields->fresh()) warn("fields.h5 was cut off while it was written: put aside as fields_before.h5");
  }
  write_record(comm_, options);
  summary.wall_seconds.setup = MPI_Wtime() - begin_ - solved_before;
  summary.memory_mb["before_solve"] = io::resident_memory_mb();
}

std::vector<std::string> RunFiles::held_names() const
{
  std::vector<std::string> names;
  for (const scene::HeldPart& part : scene.model->held_parts) names.push_back(part.name);
  for (const scene::NamedSupport& support : scene.model->supports) names.push_back(support.name);
  return names;
}

std::vector<std::string> RunFiles::turned_names() const
{
  std::vector<std::string> names;
  for (const scene::HeldPart& part : scene.model->held_parts)
    if (part.centre) names.push_back(part.name);
  return names;
}

void RunFiles::add_reaction_columns(std::vector<io::Column>& columns) const
{
  static constexpr const char* directions[] = {"x", "y", "z"};
  for (const std::string& name : held_names())
    for (int a = 0; a < scene.model->system.rows.dim; ++a)
      columns.push_back({fmt::format("reaction_{}_{}", name, directions[a]), "N"});
  for (const std::string& name : turned_names()) columns.push_back({fmt::format("moment_{}", name), "N m"});
}

std::vector<double> RunFiles::reactions(std::span<const double> force, std::span<const double> local) const
{
  const scene::Model& model = *scene.model;
  const field::Rows& rows = model.system.rows;
  const auto dim = static_cast<std::size_t>(rows.dim);
  std::vector<double> sums(dim * model.held_parts.size(), 0.0), moments;
  for (std::size_t p = 0; p < model.held_parts.size(); ++p) {
    const std::optional<Vector<2>>& centre = model.held_parts[p].centre;
    double moment = 0.0;
    for (const Index k : model.held_parts[p].components) {
      if (k / rows.dim >= rows.nodes && k / rows.dim < rows.first_particle()) continue; // forces of sets are none
      const auto c = static_cast<std::size_t>(k), axis = c % dim, other = c - axis + 1 - axis;
      sums[dim * p + axis] += force[c];
      if (!centre || axis > 1) continue;
      const double arm = model.system.coordinates[other] + local[other] - (*centre)[axis == 0 ? 1 : 0];
      moment += (axis == 0 ? -arm : arm) * force[c];
    }
    if (centre) moments.push_back(moment);
  }
  for (const scene::NamedSupport& support : model.supports) {
    const Vector<3> push = support.term->push(local);
    sums.insert(sums.end(), push.data(), push.data() + dim);
  }
  sums.insert(sums.end(), moments.begin(), moments.end());
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  return sums;
}

/// Counted from the body's corner.
std::vector<field::OutputBlock> RunFiles::blocks(Vec u, const std::vector<double>& relative_percent)
{
  std::vector<double> local;
  scene.model->system.halo->gather(u, local);
  std::vector<double> moving(velocity.begin(), velocity.end());
  moving.resize(static_cast<std::size_t>(scene.model->system.rows.owned() * scene.model->system.rows.dim), 0.0);
  return scene.model->blocks({options, local, moving, relative_percent}); // nothing moves in statics
}

void RunFiles::write_fields(double time, Vec u, const std::vector<double>& relative_percent)
{
  std::vector<field::OutputBlock> all = blocks(u, relative_percent);
  const Vector<3>& origin = options.frame.origin();
  for (field::OutputBlock& block : all)
    for (std::size_t k = 0; k < block.points.size(); ++k) block.points[k] += origin[static_cast<Eigen::Index>(k % 3)];
  fields->write(time, all);
}

Probed RunFiles::probed(Vec u)
{
  const options::PdOptions& pd = options.pd;
  const double spacing = pd.cloud.empty() && pd.any() && pd.spacing.size() == 1 ? pd.spacing[0] : 0.0;
  double reach = pd.cloud.empty() ? 0.0 : pd.horizon;
  for (const double dx : pd.spacing) reach = std::max(reach, dx);
  for (const options::PointBodyOptions& body : options.points.bodies) reach = std::max(reach, body.spacing);
  return {comm_, options.frame, static_cast<int>(scene.model->system.rows.dim), spacing, reach, [this, u](bool moving) {
            const std::vector<double> none(static_cast<std::size_t>(scene.mesh->owned_vertices()), 0.0);
            if (!moving) return blocks(u, none);
            const VecHandle v = scene.model->system.rows.vector();
            if (!velocity.empty()) field::set_owned_values(v.get(), velocity);
            return blocks(v.get(), none);
          }};
}

void RunFiles::begin_probes(int step, double time, Vec u)
{
  if (!options.probes.empty())
    probes_.begin(probed(u), step, time, continued.here ? std::optional<double>(continued.step) : std::nullopt);
}

void RunFiles::look_at_probes(int step, double time, Vec u, bool all)
{
  if (probes_.due(step, all)) probes_.look(probed(u), step, time, all);
}

void RunFiles::told_if_refused(const std::function<void()>& act)
{
  try {
    act();
  } catch (const UserError& wrong) {
    fail(wrong.what());
    throw;
  }
}

void RunFiles::fail(const std::string& why)
{
  summary.message = why;
  after_failure([&] { write_summary("failed"); });
}

void RunFiles::lost(const std::string& why) noexcept
{
  try {
    if (!LastWords::say(why)) return;
    summary.message = why;
    summary.status = "failed";
    summary.wall_seconds.total = MPI_Wtime() - begin_;
    if (!std::exchange(room_made_, true)) io::clear_earlier_files(options.output.directory, continued.here);
    (void)io::write_summary_alone(comm_, summary_path(), summary);
  } catch (...) { // the first cause has been told
  }
}

void RunFiles::after_failure(const std::function<void()>& write) const
{
  try {
    write();
  } catch (const MachineFailure& failure) {
    say_warning(failure.what());
  }
}

void RunFiles::stop(const std::string& why)
{
  summary.message = why;
  write_summary("stopped");
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0) fmt::print("{}\n", why);
}

void RunFiles::say_warning(const std::string& what) const
{
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0) fmt::print(stderr, "warning: {}\n", as_one_line(what));
}

void RunFiles::warn_of_energy()
{
  if (const double drift = summary.results.value("energy_drift_ratio", 0.0); drift > 1.0)
    warn(fmt::format("the energies are off by {:.3g} times all that was put in: these results are of no use; try a "
                     "smaller -ts_safety or -ts_dt",
                     drift));
}

void RunFiles::warn(const std::string& what)
{
  if (what.empty()) return;
  summary.warnings.push_back(as_one_line(what));
  if (!options.output.warnings_are_errors) return say_warning(what);
  const std::string error = what + " (-warnings_are_errors)";
  if (room_made_) fail(error); // else nothing has been written yet
  throw UserError(error);
}

std::filesystem::path RunFiles::summary_path() const
{
  return std::filesystem::path(options.output.directory) / "summary.json";
}

void RunFiles::write_summary(const char* status)
{
  make_room();
  if (history) history->close();
  if (fields) fields->close();
  if (fields && fields->steps() > 0 && options.output.vtkhdf) io::write_vtkhdf(comm_, options.output.directory);
  probes_.close();
  summary.status = status;
  summary.events = io::gather_event_counts(comm_);
  summary.wall_seconds.total = MPI_Wtime() - begin_;
  io::write_summary(comm_, summary_path(), summary);
}
} // namespace pdx::record
