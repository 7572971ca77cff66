#include "pdx/change/checkpoints.hpp"

#include "pdx/change/checkpoint_head.hpp"
#include "pdx/options/scene_signature.hpp"
#include "pdx/record/checkpoint_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::change {
namespace {
using Verdict = solve::TimeDriver::Verdict;
constexpr std::size_t kRankSums = 5;  // of every scene: work, broken bonds, their energy, what damping took and takes
constexpr int kMostSteps = 16;        // from one look at signals and the clock to the next
constexpr double kMostSeconds = 0.25; // likewise [s]

int rank_in(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

record::NamedNumbers numbers_of(const solve::TimeDriver::Clock& clock)
{
  return {{"time", clock.time},
          {"step", clock.step},
          {"length", clock.length},
          {"origin_time", clock.origin.time},
          {"origin_step", clock.origin.step},
          {"origin_length", clock.origin.length},
          {"energy_bound", clock.energy_bound},
          {"initial_energy", clock.initial},
          {"start_bound", clock.start_bound}};
}

solve::TimeDriver::Clock clock_of(const record::NamedNumbers& n)
{
  const auto whole = [&](const char* name) { return static_cast<int>(std::lround(n.at(name))); };
  return {n.at("time"),
          whole("step"),
          n.at("length"),
          {n.at("origin_time"), whole("origin_step"), n.at("origin_length")},
          0.0,
          n.at("energy_bound"),
          n.at("initial_energy"),
          n.at("start_bound"),
          {}};
}

/// What is wrong with the numbers of a checkpoint, "" if nothing is.
std::string fault_of(const record::NamedNumbers& numbers)
{
  for (const char* name : {"time", "step", "length", "origin_time", "origin_step", "origin_length", "energy_bound",
                           "initial_energy", "start_bound", "fields", "end", "step_length", "largest_energy",
                           "largest_residual", "converted", "relocations"})
    if (!numbers.contains(name)) return fmt::format("has no {}", name);
  for (const char* name : {"step", "origin_step", "fields", "relocations"})
    if (const double n = numbers.at(name); n < 0.0 || n > 2147483647.0 || n != std::floor(n))
      return fmt::format("has {} {}: must be a whole number from 0 on", name, n);
  for (const char* name : {"time", "length", "origin_time", "origin_length", "end", "step_length"})
    if (const double n = numbers.at(name); n < 0.0) return fmt::format("has {} {} s: must be at least 0", name, n);
  return "";
}
} // namespace

Checkpoints::Checkpoints(record::RunFiles& files, PatchMover& mover)
    : files_(files), mover_(mover), options_(files.options.time.checkpoint),
      given_(options::given_scene(files.comm(), files.options)), looked_(MPI_Wtime()), written_(looked_)
{
  if (!options_.restart.empty()) read_head();
}

void Checkpoints::read_head()
{
  CheckpointHead head = change::read_head(files_, mover_, given_, fault_of);
  from_ = std::move(head.file);
  head_ = std::move(head.numbers);
  from_layout_ = std::move(head.layout);
  dormant_ = std::move(head.dormant);
}

record::SceneTables& Checkpoints::tables()
{
  if (!tables_) tables_ = std::make_unique<record::SceneTables>(scene_);
  return *tables_;
}

void Checkpoints::stand_on(const scene::Standing& scene, const scene::Layout& layout)
{
  scene_ = scene;
  layout_ = layout;
  tables_.reset();
}

void Checkpoints::take_scene(const scene::Standing& scene, const scene::Layout& layout, const scene::Dormant& dormant,
                             const record::TimeRecorder& recorder)
{
  stand_on(scene, layout);
  dormant_ = dormant;
  sound_ = kept_now(recorder);
}

void Checkpoints::begin(const scene::Standing& scene, const scene::Layout& layout, solve::TimeDriver& driver,
                        record::TimeRecorder& recorder)
{
  stand_on(scene, layout);
  step_length_ = step_given_ = driver.step_length();
  sound_ = kept_now(recorder);
  if (!from_) return;
  record::refuse_another(*from_, options_.restart, record::kStandingScene, tables().scene());
  solve::TimeDriver::Clock clock = clock_of(head_);
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-ts_dt", &given));
  step_given_ = head_.contains("step_given") ? head_.at("step_given") : head_.at("step_length");
  if (given && step_length_ != head_.at("step_length") && step_length_ != step_given_)
    throw UserError(fmt::format("-ts_dt is {:g}, but the steps of {} are {:.17g} s long: give that, or none",
                                step_length_, options_.restart, head_.at("step_length")));
  step_length_ = head_.at("step_length");
  if (driver.end_time() != head_.at("end")) clock.length = step_length_; // the last steps before that end were shorter
  read_sums(clock);
  const scene::NamedState state = record::read_tables(files_.comm(), *from_, scene.model->system.rows.dim);
  const scene::StateMove move(state, scene);
  from_->require(move.misfit().table, move.misfit().why);
  std::optional<scene::CrackNotes> cracks = move.cracks();
  const bool strange = cracks && recorder.cracks() && !recorder.cracks()->knows(*cracks);
  from_->require("/crack_arrivals", strange ? "names a particle that is not there" : "");
  move.break_bonds();
  move.hold_grips();
  driver.resume(clock, move.moving());
  if (cracks && recorder.cracks()) recorder.cracks()->take_notes(std::move(*cracks));
  from_.reset();
  recorder.take_notes(head_);
  sound_ = kept_now(recorder);
  sound_.numbers = head_;
  next_look_ = clock.step;
  looked_step_ = clock.step;
  files_.progress.line(
      fmt::format("restarted from {}: step {}, time {:.6g} s", options_.restart, clock.step, clock.time));
}

/// Sums of ranks go back to their ranks, where there are as many: then all further sums are the same to the last bit.
void Checkpoints::read_sums(solve::TimeDriver::Clock& clock) const
{
  int ranks = 1;
  MPI_Comm_size(files_.comm(), &ranks);
  const auto rank = static_cast<std::size_t>(rank_in(files_.comm()));
  std::vector<double> mine(kRankSums + files_.scene.model->rank_sums().size(), 0.0);
  const std::size_t width = mine.size();
  std::vector<double> sums(width * static_cast<std::size_t>(from_->shape("/rank_sums")[0]));
  from_->read("/rank_sums", 0, static_cast<int>(width), std::span<double>(sums));
  if (sums.size() == width * static_cast<std::size_t>(ranks))
    std::copy_n(sums.begin() + static_cast<std::ptrdiff_t>(width * rank), width, mine.begin());
  else if (rank == 0)
    for (std::size_t k = 0; k < sums.size(); ++k) mine[k % width] += sums[k];
  clock.work = mine[0];
  clock.damped = {mine[3], mine[4]};
  files_.scene.model->resume_sums(std::span(mine).subspan(kRankSums));
  if (breaker()) breaker()->resume({std::llround(mine[1]), mine[2]});
}

void Checkpoints::write_sums(io::Hdf5File& file, const solve::TimeDriver& driver) const
{
  const pd::Broken broken = breaker() ? breaker()->mine() : pd::Broken{};
  const solve::MovingSystem::Damped& damped = driver.moving().damped();
  std::vector<double> mine{driver.moving().work(), static_cast<double>(broken.bonds), broken.energy, damped.energy,
                           damped.power};
  const std::vector<double> more = files_.scene.model->rank_sums();
  mine.insert(mine.end(), more.begin(), more.end());
  file.dataset("/rank_sums", std::span<const double>(mine), static_cast<int>(mine.size()));
}

Checkpoints::Kept Checkpoints::kept_now(const record::TimeRecorder& recorder) const
{
  Kept kept{recorder.notes(), std::nullopt};
  kept.numbers["fields"] = files_.fields ? files_.fields->steps() : 0;
  if (recorder.cracks()) kept.cracks = recorder.cracks()->notes();
  return kept;
}

/// Ranks agree on what signals say and on whether it is time: every few steps, more often where steps are long.
void Checkpoints::look_around(const solve::TimeDriver& driver)
{
  const int step = driver.step();
  const double now = MPI_Wtime(), steps = std::max(1, step - looked_step_);
  const bool late = options_.seconds > 0.0 && now - written_ >= options_.seconds && rank_in(files_.comm()) == 0;
  double all[] = {static_cast<double>(StopSignals::caught()), late ? 1.0 : 0.0, (now - looked_) / steps};
  MPI_Allreduce(MPI_IN_PLACE, all, 3, MPI_DOUBLE, MPI_MAX, files_.comm());
  due_ = {static_cast<int>(all[0]), static_cast<int>(all[1])};
  const double pause = all[2] > 0.0 ? kMostSeconds / all[2] : kMostSteps;
  next_look_ = step + static_cast<int>(std::clamp(pause, 1.0, static_cast<double>(kMostSteps)));
  looked_ = now;
  looked_step_ = step;
}

Verdict Checkpoints::after_step(const solve::TimeDriver& driver, const record::TimeRecorder& recorder)
{
  const int step = driver.step();
  if (driver.good_step() == step) sound_ = kept_now(recorder);
  if (step >= driver.expected_steps()) return Verdict::go_on; // `finish` does it
  due_ = {};
  if (step >= next_look_) look_around(driver);
  const bool due = due_.signal || due_.write || (options_.interval > 0 && step % options_.interval == 0);
  if (due) write(driver, kept_now(recorder));
  if (!due_.signal) return Verdict::go_on;
  const std::string file = record::checkpoint_in(files_.options.output.directory).string();
  stopped_ = fmt::format("stopped by {} at step {}, time {:.6g} s: checkpoint written to {}; go on with -restart {}",
                         StopSignals::name(due_.signal), step, driver.time(), file, file);
  return Verdict::stop;
}

void Checkpoints::finish(const solve::TimeDriver& driver, const record::TimeRecorder& recorder)
{
  if (asked()) write(driver, kept_now(recorder));
}

void Checkpoints::failed(const solve::TimeDriver& driver)
{
  if (scene_.model && !sound_.numbers.empty()) write(driver, sound_);
}

void Checkpoints::write(const solve::TimeDriver& driver, Kept kept)
{
  Numbers& numbers = kept.numbers;
  for (const auto& [name, value] : numbers_of(driver.clock())) numbers[name] = value;
  numbers["end"] = driver.end_time();
  numbers["step_length"] = step_length_;
  numbers["step_given"] = step_given_;
  record::write_checkpoint(files_.comm(), record::checkpoint_in(files_.options.output.directory),
                           [&](io::Hdf5File& file) {
                             file.text(record::kGivenOptions, given_);
                             file.text(record::kStandingScene, tables().scene());
                             layout_.write(file);
                             if (files_.options.layout.patches_move()) dormant_.write(file);
                             if (mover_.follows()) mover_.write(file);
                             record::write_numbers(file, numbers);
                             write_sums(file, driver);
                             tables().write(file, scene::capture(scene_, driver, kept.cracks));
                           });
  written_ = MPI_Wtime();
}
} // namespace pdx::change
