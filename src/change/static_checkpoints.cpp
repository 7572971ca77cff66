#include "pdx/change/static_checkpoints.hpp"

#include "pdx/change/checkpoint_head.hpp"
#include "pdx/options/scene_signature.hpp"

#include <cmath>
#include <fmt/format.h>

namespace pdx::change {
namespace {
constexpr const char* kMarks = "/crack_marks"; // number of the tip, load, how far it had come [m]

record::NamedNumbers numbers_of(const solve::StaticReport& report)
{
  return {{"step", report.steps},
          {"newton_iterations", report.newton_iterations},
          {"linear_iterations", report.linear_iterations},
          {"jacobian_assemblies", report.jacobian_assemblies},
          {"preconditioner_builds", report.preconditioner_builds},
          {"solves", report.solves},
          {"passes", report.passes},
          {"halvings", report.halvings},
          {"changes", static_cast<double>(report.changes)}};
}

solve::StaticReport report_of(const record::NamedNumbers& n)
{
  const auto whole = [&](const char* name) { return static_cast<int>(std::lround(n.at(name))); };
  solve::StaticReport report;
  report.steps = whole("step");
  report.newton_iterations = whole("newton_iterations");
  report.linear_iterations = whole("linear_iterations");
  report.jacobian_assemblies = whole("jacobian_assemblies");
  report.preconditioner_builds = whole("preconditioner_builds");
  report.solves = whole("solves");
  report.passes = whole("passes");
  report.halvings = whole("halvings");
  report.changes = std::llround(n.at("changes"));
  return report;
}

/// What is wrong with the numbers of a checkpoint, "" if nothing is.
std::string fault_in(const record::NamedNumbers& numbers)
{
  for (const char* name :
       {"step", "newton_iterations", "linear_iterations", "jacobian_assemblies", "preconditioner_builds", "solves",
        "passes", "halvings", "changes", "increments", "relocations", "fields", "bonds_broken"}) {
    if (!numbers.contains(name)) return fmt::format("has no {}", name);
    if (const double n = numbers.at(name); !(n >= 0.0 && n < 2147483648.0 && n == std::floor(n)))
      return fmt::format("has {} {}: must be a whole number from 0 on", name, n);
  }
  for (const char* name : {"load", "part_done", "part_size", "energy_broken"}) {
    if (!numbers.contains(name)) return fmt::format("has no {}", name);
    const double n = numbers.at(name);
    const bool share = name != std::string_view("energy_broken");
    if (!(n >= 0.0 && (!share || n <= 1.0))) return fmt::format("has {} {}", name, n);
  }
  return record::Recorder::fault_of(numbers);
}

std::vector<record::StaticCracks::Mark> read_marks(const io::SealedReader& file)
{
  std::vector<double> table(3 * static_cast<std::size_t>(file.shape(kMarks)[0]));
  file.read(kMarks, 0, 3, std::span<double>(table));
  std::vector<record::StaticCracks::Mark> marks;
  for (std::size_t k = 0; k < table.size(); k += 3) {
    const bool good = table[k] >= 0.0 && table[k] < 1e6 && table[k] == std::floor(table[k]);
    file.require(kMarks, good ? "" : fmt::format("has a tip {}", table[k]));
    marks.push_back({static_cast<std::size_t>(table[k]), table[k + 1], table[k + 2]});
  }
  return marks;
}

void write_marks(io::Hdf5File& file, const std::vector<record::StaticCracks::Mark>& marks)
{
  int rank = 0;
  MPI_Comm_rank(file.comm(), &rank);
  std::vector<double> table;
  for (const record::StaticCracks::Mark& mark : marks)
    if (rank == 0) table.insert(table.end(), {static_cast<double>(mark.end), mark.load, mark.grown});
  file.dataset(kMarks, std::span<const double>(table), 3);
}
} // namespace

StaticCheckpoints::StaticCheckpoints(record::RunFiles& files, PatchMover& mover)
    : files_(files), mover_(mover), options_(files.options.time.checkpoint),
      given_(options::given_scene(files.comm(), files.options)), written_(MPI_Wtime())
{
  if (options_.restart.empty()) return;
  CheckpointHead head = read_head(files_, mover_, given_, fault_in);
  from_ = std::move(head.file);
  head_ = std::move(head.numbers);
  layout_ = std::move(head.layout);
  dormant_ = std::move(head.dormant);
}

StaticCheckpoints::Start StaticCheckpoints::start(const scene::Standing& scene, solve::LoadPath& path)
{
  record::refuse_another(*from_, options_.restart, record::kStandingScene, record::SceneTables(scene).scene());
  const double done = head_.at("part_done");
  if (!path.go_on_from({static_cast<int>(head_.at("increments")), done, head_.at("part_size")}))
    throw UserError(fmt::format("-load_halvings is {}, but {} stands within an increment, at {:.10g} of it: give as "
                                "many as before, or more",
                                files_.options.load.halvings, options_.restart, done));
  const scene::NamedState state = record::read_tables(files_.comm(), *from_, scene.model->system.rows.dim);
  const scene::StateMove move(state, scene);
  from_->require(move.misfit().table, move.misfit().why);
  move.break_bonds();
  if (scene.model->fracture)
    scene.model->fracture->resume({std::llround(head_.at("bonds_broken")), head_.at("energy_broken")});
  files_.summary.relocations = std::llround(head_.at("relocations"));
  Start start{move.rows(state.moving.u, state.dim), report_of(head_), head_.at("load"), {head_, read_marks(*from_)}};
  from_.reset();
  files_.progress.line(
      fmt::format("restarted from {}: load {:.6g}, step {}", options_.restart, start.load, start.report.steps));
  return start;
}

std::string StaticCheckpoints::file() const { return record::checkpoint_in(files_.options.output.directory).string(); }

bool StaticCheckpoints::due(int step, bool last) const
{
  int late = options_.seconds > 0.0 && MPI_Wtime() - written_ >= options_.seconds;
  MPI_Bcast(&late, 1, MPI_INT, 0, files_.comm());
  return late || (last && asked()) || (options_.interval > 0 && step % options_.interval == 0);
}

void StaticCheckpoints::write(const BetweenLoads& now)
{
  record::RecorderNotes notes = now.recorder.notes();
  record::NamedNumbers& numbers = notes.numbers;
  numbers.merge(numbers_of(now.report));
  const solve::LoadPath::Place place = now.path.place();
  const couple::Fracture* fracture = now.scene.model->fracture;
  const pd::Broken broken = fracture ? fracture->all() : pd::Broken{};
  numbers.merge(record::NamedNumbers{{"load", now.load},
                                     {"increments", place.increments},
                                     {"part_done", place.done},
                                     {"part_size", place.size},
                                     {"bonds_broken", static_cast<double>(broken.bonds)},
                                     {"energy_broken", broken.energy},
                                     {"relocations", static_cast<double>(files_.summary.relocations)},
                                     {"fields", files_.fields ? files_.fields->steps() : 0}});
  scene::NamedState state = scene::capture(now.scene);
  state.moving.u = field::owned_values(now.u);
  const record::SceneTables tables(now.scene);
  record::write_checkpoint(files_.comm(), file(), [&](io::Hdf5File& file) {
    file.text(record::kGivenOptions, given_);
    file.text(record::kStandingScene, tables.scene());
    now.layout.write(file);
    if (files_.options.layout.patches_move()) now.dormant.write(file);
    if (mover_.follows()) mover_.write(file);
    record::write_numbers(file, numbers);
    write_marks(file, notes.marks);
    tables.write(file, state);
  });
  written_ = MPI_Wtime();
}
} // namespace pdx::change
