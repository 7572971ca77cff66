#include "pdx/record/time_recorder.hpp"

#include "pdx/law/solid_law.hpp"
#include "pdx/record/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::record {
namespace {
constexpr double kHalf = 0.5 + 1e-6; // of a step: a time midway between two belongs to the first, whatever rounding

/// In which sound crosses a cell of material points, the shortest of all bodies; 0 without them [s].
double acoustic_step(const options::SceneOptions& options)
{
  double shortest = 0.0;
  for (const options::PointBodyOptions& body : options.points.bodies) {
    const double speed = options.solid ? law::Corotational<3>(body.elastic).wave_speed(Tensor<3>::Zero())
                                       : law::Corotational<2>(body.elastic).wave_speed(Tensor<2>::Zero());
    const double step = options.points.ratio * body.spacing / speed;
    shortest = shortest > 0.0 ? std::min(shortest, step) : step;
  }
  return shortest;
}

/// What `scene::BodyLedger::start` is called among notes.
std::string start_name(std::size_t k) { return fmt::format("bodies_start {}", k); }

/// What broke, and where cracks have come to, as the log of a run in time ends.
std::string broken_line(const io::Summary& summary)
{
  constexpr std::size_t most_tips = 3;
  const auto& results = summary.results;
  std::string line =
      fmt::format("{} bonds broken, {:.4g} J", summary.bonds_broken, results.value("fracture_energy", 0.0));
  if (const auto length = results.find("crack_length"); length != results.end())
    line += fmt::format("; cracks {:.4g} m long", length->get<double>());
  const auto tips = results.find("crack_tips");
  if (tips == results.end()) return line;
  for (std::size_t k = 0; k < tips->size() && k < most_tips; ++k)
    line += fmt::format("{} ({:.6g}, {:.6g})", k ? " and" : ", tips at", tips->at(k).at(0).get<double>(),
                        tips->at(k).at(1).get<double>());
  if (tips->size() > most_tips) line += fmt::format(" and {} more", tips->size() - most_tips);
  return line;
}
} // namespace

void TimeRecorder::built(const scene::Standing& scene)
{
  files_.built(scene);
  d_ = scene.model;
  cracks_ = CrackWatch::make(files_);
  if (files_.options.post.section >= 0 && !sections_) sections_.emplace(files_);
  if (!files_.options.output.history) return;
  std::vector<io::Column> columns{{"step", "-"}, {"time", "s"}};
  if (d_->has_others())
    columns.insert(columns.end(), {{"energy_kinetic_elements", "J"},
                                   {"energy_kinetic_particles", "J"},
                                   {"energy_elements", "J"},
                                   {"energy_bonds", "J"},
                                   {"energy_interface", "J"}});
  if (d_->has_points())
    columns.insert(columns.end(), {{"energy_kinetic_points", "J"},
                                   {"energy_points", "J"},
                                   {"energy_contact", "J"},
                                   {"energy_friction", "J"},
                                   {"energy_viscous", "J"}});
  if (!d_->supports.empty()) columns.push_back({"energy_supports", "J"});
  columns.insert(columns.end(), {{"energy_scheme", "J"}, {"work", "J"}, {"energy_residual", "J"}});
  for (io::Column& column : d_->more_columns()) columns.push_back(std::move(column));
  if (d_->breaker) columns.insert(columns.end(), {{"energy_fracture", "J"}, {"bonds_broken", "-"}});
  if (cracks_) CrackWatch::columns(columns);
  files_.add_layout_columns(columns);
  files_.add_reaction_columns(columns);
  files_.expect_history(std::move(columns));
}

void TimeRecorder::started(const solve::TimeDriver& driver, const scene::StepLimits& limits)
{
  limits_ = limits;
  first_step_ = driver.step();
  files_.started();
  const double acoustic = acoustic_step(files_.options);
  files_.progress.line(fmt::format(
      "{} steps of {:.4g} s{}; stable limit {:.4g} s{}{}", driver.expected_steps(), driver.step_length(),
      files_.options.time.subcycle > 1 ? fmt::format(", particles take {} in each", files_.options.time.subcycle) : "",
      limits.rigorous, limits.papers > 0.0 ? fmt::format(", the papers' Eq. 26 {:.4g} s", limits.papers) : "",
      acoustic > 0.0 ? fmt::format(", sound crosses a cell of points in {:.4g} s", acoustic) : ""));
  if (cracks_ && !cracks_->looked()) cracks_->look(driver.time(), 0);
  files_.begin_probes(driver.step(), driver.time(), driver.displacement());
  begin_ = MPI_Wtime();
}

std::optional<scene::CrackNotes> TimeRecorder::leave_scene(const solve::TimeDriver& driver, bool for_another)
{
  const MotionEnergies e = energies(driver);
  left_ = e.total();
  if (d_->bodies) bodies_start_ = d_->bodies->start();
  if (cracks_ && for_another) { // what broke here is seen, whenever rows of the history are due
    count(e);
    cracks_->look(driver.time(), broken_.bonds);
  }
  tiles_ += d_->tiles().value_or(scene::Tiles{});
  cells_ += d_->cells_of_points();
  return cracks_ ? cracks_->notes() : std::nullopt;
}

void TimeRecorder::take_scene(const scene::Standing& scene, const solve::TimeDriver& driver,
                              std::optional<scene::CrackNotes> cracks)
{
  files_.take_scene(scene);
  d_ = scene.model;
  cracks_ = CrackWatch::make(files_);
  if (cracks_ && cracks) cracks_->take_notes(std::move(*cracks));
  if (cracks_) cracks_->note_new();
  if (d_->bodies) d_->bodies->begin_with(bodies_start_);
  converted_ += energies(driver).total() - left_;
}

void TimeRecorder::tell_shorter(const solve::TimeDriver& driver, double before, double limit)
{
  const std::string text = fmt::format("step {}: steps of {:.4g} s from here, for the particles that came",
                                       driver.step(), driver.step_length());
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsHasName(nullptr, nullptr, "-ts_dt", &given));
  if (given)
    files_.warn(
        fmt::format("{}: the -ts_dt of {:g} s is above the stable limit beside them, {:.4g} s", text, before, limit));
  else
    files_.progress.line(text);
}

TimeRecorder::Notes TimeRecorder::notes() const
{
  Notes notes{{"largest_energy", largest_energy_},
              {"largest_residual", largest_residual_},
              {"converted", converted_},
              {"relocations", static_cast<double>(files_.summary.relocations)}};
  if (sections_) sections_->add_notes(notes);
  const std::vector<double> start = d_->bodies ? d_->bodies->start() : std::vector<double>{};
  for (std::size_t k = 0; k < start.size(); ++k) notes[start_name(k)] = start[k];
  return notes;
}

MotionEnergies TimeRecorder::energies(const solve::TimeDriver& driver) const
{
  MotionEnergies e;
  const solve::KineticEnergy kinetic = driver.kinetic_energy();
  e.scheme = kinetic.scheme;
  e.stored = d_->energies(driver.local());
  e.initial = driver.clock().initial;
  e.converted = converted_;
  const pd::Broken broken = d_->breaker ? d_->breaker->mine() : pd::Broken{};
  double sums[] = {e.stored.elements,      e.stored.bonds,
                   e.stored.interface,     broken.energy,
                   e.stored.points,        e.stored.contact,
                   e.stored.friction,      driver.moving().damped().energy,
                   driver.moving().work(), d_->kinetic_of_points(driver.v()),
                   e.stored.supports};
  MPI_Allreduce(MPI_IN_PLACE, sums, 11, MPI_DOUBLE, MPI_SUM, files_.comm());
  e.stored = {sums[0], sums[1], sums[2], sums[3], sums[4], sums[5], sums[6], sums[7], sums[10]};
  e.work = sums[8];
  e.kinetic_particles = kinetic.particles;
  e.kinetic_points = sums[9];
  e.kinetic_elements = kinetic.moving - kinetic.particles - e.kinetic_points;
  return e;
}

void TimeRecorder::count(const MotionEnergies& e)
{
  if (!d_->breaker) return;
  broken_ = d_->breaker->mine();
  MPI_Allreduce(MPI_IN_PLACE, &broken_.bonds, 1, MPI_INT64_T, MPI_SUM, files_.comm());
  broken_.energy = e.stored.dissipated;
  files_.summary.bonds_broken = broken_.bonds;
}

MotionEnergies TimeRecorder::look(const solve::TimeDriver& driver)
{
  const MotionEnergies e = energies(driver);
  count(e);
  if (cracks_) cracks_->look(driver.time(), broken_.bonds);
  if (sections_) sections_->look(driver.time(), broken_.bonds);
  largest_energy_ = std::max(largest_energy_, e.initial + e.work);
  largest_residual_ = std::max(largest_residual_, std::abs(e.residual()));
  if (files_.history && !told(driver)) write_history(driver, e);
  return e;
}

/// What a restarted run begins with stands in its files already.
bool TimeRecorder::told(const solve::TimeDriver& driver) const
{
  return files_.continued.here && driver.step() == files_.continued.step;
}

void TimeRecorder::take_notes(const Notes& notes)
{
  largest_energy_ = notes.at("largest_energy");
  largest_residual_ = notes.at("largest_residual");
  converted_ = notes.at("converted");
  if (sections_) sections_->take_notes(notes);
  std::vector<double> start = d_->bodies ? d_->bodies->start() : std::vector<double>{};
  for (std::size_t k = 0; k < start.size(); ++k)
    if (const auto known = notes.find(start_name(k)); known != notes.end()) start[k] = known->second;
  if (d_->bodies) d_->bodies->begin_with(start);
  files_.summary.relocations = std::llround(notes.at("relocations"));
}

void TimeRecorder::write_history(const solve::TimeDriver& driver, const MotionEnergies& e)
{
  std::vector<double> row{static_cast<double>(driver.step()), driver.time()};
  if (d_->has_others())
    row.insert(row.end(),
               {e.kinetic_elements, e.kinetic_particles, e.stored.elements, e.stored.bonds, e.stored.interface});
  if (d_->has_points())
    row.insert(row.end(), {d_->has_others() ? e.kinetic_points : e.kinetic(), e.stored.points, e.stored.contact,
                           e.stored.friction, e.stored.viscous});
  if (!d_->supports.empty()) row.push_back(e.stored.supports);
  row.insert(row.end(), {e.scheme, e.work, e.residual()});
  d_->add_more(driver.local(), driver.v(), row);
  if (d_->breaker) row.insert(row.end(), {e.stored.dissipated, static_cast<double>(broken_.bonds)});
  if (cracks_) cracks_->row(row);
  files_.add_layout_row(row, converted_);
  std::vector<double> held;
  driver.moving().held_force(held);
  const std::vector<double> reactions = files_.reactions(held, driver.local());
  row.insert(row.end(), reactions.begin(), reactions.end());
  files_.history->row(row);
}

/// Takes off the times that are nearer to this step than to the next.
bool TimeRecorder::fields_due(const solve::TimeDriver& driver)
{
  const options::OutputOptions& output = files_.options.output;
  if (!files_.fields) return false;
  bool due = driver.step() % output.interval == 0;
  for (; next_time_ < output.times.size(); ++next_time_) {
    if (output.times[next_time_] > driver.time() + kHalf * driver.step_length()) break;
    due = due || output.times[next_time_] >= driver.time() - 0.5 * driver.step_length();
  }
  return due;
}

void TimeRecorder::after_step(const solve::TimeDriver& driver)
{
  const options::OutputOptions& output = files_.options.output;
  const int step = driver.step(), last = driver.expected_steps();
  files_.summary.steps = step;
  const bool looks = (output.history || d_->breaker) && step % output.history_interval == 0;
  const bool pictures = fields_due(driver);
  if (step >= last) return; // `finish` does it
  const bool probes = files_.probes_due(step);
  if (looks || pictures || probes) {
    const double begin = MPI_Wtime();
    if (probes) files_.look_at_probes(step, driver.time(), driver.displacement());
    if (looks) look(driver);
    if (pictures) {
      files_.write_fields(driver.time(), driver.displacement());
      pictured_ = step;
    }
    output_ += MPI_Wtime() - begin;
  }
  if (!files_.progress.due(step, last)) return;
  std::string text = fmt::format("time {:.4g} s", driver.time());
  if (d_->breaker) text += fmt::format(", {} bonds broken", broken_.bonds);
  files_.progress.step(step, last, text);
}

void TimeRecorder::write_results(const solve::TimeDriver& driver, const MotionEnergies& e)
{
  auto& results = files_.summary.results;
  results["time"] = driver.time();
  results["step_length"] = driver.step_length();
  results["stable_step"] = limits_.rigorous;
  if (files_.options.time.subcycle > 1) results["subcycle"] = files_.options.time.subcycle;
  if (limits_.papers > 0.0) results["stable_step_papers"] = limits_.papers;
  if (const double acoustic = acoustic_step(files_.options); acoustic > 0.0) results["stable_step_acoustic"] = acoustic;
  results["kinetic_energy"] = e.kinetic();
  results["strain_energy"] = e.stored.elastic();
  results["strain_energy_elements"] = e.stored.elements;
  results["strain_energy_bonds"] = e.stored.bonds;
  results["strain_energy_interface"] = e.stored.interface;
  if (!d_->supports.empty()) results["strain_energy_supports"] = e.stored.supports;
  results["external_work"] = e.work;
  results["initial_energy"] = e.initial;
  files_.add_layout_results(e.converted, e.initial + e.work);
  if (d_->has_points()) {
    results["strain_energy_points"] = e.stored.points;
    results["strain_energy_contact"] = e.stored.contact;
    results["friction_energy"] = e.stored.friction;
    results["viscous_energy"] = e.stored.viscous;
  }
  write_tiles();
  write_cells();
  if (d_->breaker) {
    results["fracture_energy"] = e.stored.dissipated;
    results["critical_stretch"] = d_->critical_stretch;
  }
  if (sections_) sections_->write_results(results);
  if (cracks_) {
    cracks_->write_results(results);
    cracks_->write_paths();
  }
  if (d_->bodies) {
    results["material_points"] = d_->material_points;
    d_->bodies->add_results(driver.local(), driver.v(), results);
  }
  if (largest_energy_ > 0.0) {
    results["energy_drift_ratio"] = largest_residual_ / largest_energy_;
    if (files_.summary.unknowns.pd > 0)
      results["pd_energy_ratio_final"] = (e.kinetic_particles + e.stored.bonds + e.stored.interface) / largest_energy_;
  }
}

/// Tiles of bonds in all passes of an explicit run.
void TimeRecorder::write_tiles()
{
  const std::optional<scene::Tiles> now = d_->tiles();
  if (files_.summary.unknowns.pd == 0 || !now) return;
  if (files_.options.time.analysis != options::Analysis::explicit_dynamics) return;
  scene::Tiles all = tiles_;
  all += *now;
  std::int64_t tiles[] = {all.computed, all.skipped};
  MPI_Allreduce(MPI_IN_PLACE, tiles, 2, MPI_INT64_T, MPI_SUM, files_.comm());
  files_.summary.results["pd_tiles_computed"] = tiles[0];
  files_.summary.results["pd_tiles_skipped"] = tiles[1];
}

/// Cells of material points in all passes of an explicit run.
void TimeRecorder::write_cells()
{
  if (files_.options.time.analysis != options::Analysis::explicit_dynamics) return;
  scene::Tiles cells = cells_;
  cells += d_->cells_of_points();
  std::int64_t counts[] = {cells.computed, cells.skipped};
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, files_.comm());
  if (counts[0] + counts[1] == 0) return;
  files_.summary.results["mpm_cells_computed"] = counts[0];
  files_.summary.results["mpm_cells_skipped"] = counts[1];
}

void TimeRecorder::finish(const solve::TimeDriver& driver)
{
  const double end = MPI_Wtime();
  const MotionEnergies e = look(driver);
  if (files_.fields && !told(driver)) files_.write_fields(driver.time(), driver.displacement());
  files_.look_at_probes(driver.step(), driver.time(), driver.displacement(), true);
  write_results(driver, e);
  files_.warn_of_energy();
  count_seconds(end);
  files_.summary.steps = driver.step();
  files_.write_summary("done");
  print_phases(driver);
}

void TimeRecorder::count_seconds(double output_begin)
{
  const double now = MPI_Wtime();
  output_ += now - output_begin;
  files_.summary.wall_seconds.solve = now - begin_ - output_;
  files_.summary.wall_seconds.output = output_;
}

void TimeRecorder::interrupted(const solve::TimeDriver& driver)
{
  const double begin = MPI_Wtime();
  const MotionEnergies e = energies(driver);
  count(e);
  write_results(driver, e);
  count_seconds(begin);
  files_.summary.steps = driver.step();
  print_phases(driver);
}

void TimeRecorder::stopped_at(const solve::TimeDriver& driver)
{
  files_.summary.steps = driver.step();
  files_.summary.wall_seconds.solve = MPI_Wtime() - begin_ - output_;
  const MotionEnergies e = energies(driver);
  count(e);
  if (files_.fields && pictured_ != driver.step()) files_.write_fields(driver.time(), driver.displacement());
  write_results(driver, e);
}

void TimeRecorder::print_phases(const solve::TimeDriver& driver)
{
  const auto& seconds = files_.summary.wall_seconds;
  const double rows = static_cast<double>(d_->system.rows.total);
  const std::vector<io::Phase> phases{
      {"set-up", seconds.setup, ""},
      {"steps", seconds.solve, fmt::format("{:.3g} row-steps/s", rows * (driver.step() - first_step_) / seconds.solve)},
      {"output", seconds.output, ""}};
  files_.progress.phases(phases);
  if (files_.layout_seconds > 0.0)
    files_.progress.line(fmt::format("changes of layout: {:.3f} s of the steps", files_.layout_seconds));
  if (d_->breaker) files_.progress.line(broken_line(files_.summary));
  files_.progress.line(citation_line(files_.options));
}
} // namespace pdx::record
