#include "pdx/record/recorder.hpp"

#include "pdx/record/crack_results.hpp"
#include "pdx/record/run_record.hpp"
#include "pdx/scene/scene_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace pdx::record {
namespace {
constexpr std::size_t kMostSolves = 1000; // that are listed one by one

template <class T> nlohmann::ordered_json series(const std::vector<T>& values)
{
  if (values.empty()) return nullptr;
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  return {{"max", *std::max_element(values.begin(), values.end())},
          {"mean", sum / static_cast<double>(values.size())},
          {"list", std::vector<T>(values.begin(), values.begin() + std::min(values.size(), kMostSolves))}};
}
} // namespace

void Recorder::built(mesh::Mesh& mesh, const scene::Discretisation& d)
{
  files_.built({&mesh, &d});
  d_ = &d;
  cracks_ = std::make_unique<StaticCracks>(files_);
  if (files_.grows() || options_.output.history) ledger_ = std::make_unique<post::EnergyLedger>(d_->system);
  if (options_.output.history) open_history();
}

void Recorder::take_scene(mesh::Mesh& mesh, const scene::Discretisation& d, double load, std::vector<double> u,
                          std::span<const double> internal_force)
{
  files_.take_scene({&mesh, &d});
  d_ = &d;
  if (!ledger_) return;
  ledger_ = std::make_unique<post::EnergyLedger>(
      d_->system,
      post::LedgerState{std::move(u), post::external_force(d_->system, load, internal_force), ledger_->balance()},
      load);
}

void Recorder::open_history()
{
  std::vector<io::Column> columns{
      {"step", "-"}, {"load", "-"}, {"energy_elements", "J"}, {"energy_bonds", "J"}, {"energy_interface", "J"},
      {"work", "J"}};
  if (d_->has_points()) columns.insert(columns.end() - 1, {{"energy_points", "J"}, {"energy_contact", "J"}});
  if (!d_->supports.empty()) columns.insert(columns.end() - 1, {"energy_supports", "J"});
  if (options_.thermal.duration > 0.0) columns.insert(columns.begin() + 2, {"time", "s"});
  if (files_.grows()) {
    columns.insert(columns.end(), {{"energy_fracture", "J"}, {"passes", "-"}, {"bonds_broken", "-"}});
    cracks_->add_columns(columns);
  }
  if (options_.post.modes) cracks_->add_mode_columns(columns);
  files_.add_layout_columns(columns);
  files_.add_reaction_columns(columns);
  files_.expect_history(std::move(columns));
}

/// Energies, work and reactions at an accepted load.
void Recorder::take_stock(const solve::Step& step, Vec u, const solve::StaticSolver& driver)
{
  std::vector<double> local, force = driver.unbalanced_force(u, step.load); // reactions where held
  d_->system.halo->gather(u, local);
  post::Energies mine = d_->energies(local);
  int rank = 0;
  MPI_Comm_rank(files_.comm(), &rank);
  if (files_.grows() && rank == 0) mine.dissipated = d_->fracture->dissipated();
  reactions_.now = files_.reactions(force, local);
  reactions_.peak.resize(reactions_.now.size(), 0.0);
  reactions_.peak_load.resize(reactions_.now.size(), 0.0);
  for (std::size_t k = 0; k < reactions_.now.size(); ++k)
    if (std::abs(reactions_.now[k]) > std::abs(reactions_.peak[k])) {
      reactions_.peak[k] = reactions_.now[k];
      reactions_.peak_load[k] = step.load;
    }
  for (std::size_t k = 0; k < force.size(); ++k) force[k] += step.load * d_->system.load[k]; // internal force
  ledger_->accept(step.load, local, force, mine);
}

void Recorder::write_history(const solve::Step& step, Vec u)
{
  const post::EnergyBalance& balance = ledger_->balance();
  std::vector<double> row{static_cast<double>(step.number), step.load, balance.energies.elements,
                          balance.energies.bonds, balance.energies.interface};
  if (d_->has_points()) row.insert(row.end(), {balance.energies.points, balance.energies.contact});
  if (!d_->supports.empty()) row.push_back(balance.energies.supports);
  row.push_back(balance.work);
  if (options_.thermal.duration > 0.0) row.insert(row.begin() + 2, options_.thermal.time(step.load));
  if (files_.grows()) {
    row.insert(row.end(), {balance.energies.dissipated, static_cast<double>(step.passes),
                           static_cast<double>(d_->fracture->broken())});
    cracks_->add_row(row);
  }
  if (options_.post.modes) {
    std::vector<double> local;
    d_->system.halo->gather(u, local);
    cracks_->add_modes(modes_of_tips({*files_.scene.mesh, options_, *d_->patch_plan, *d_, local}, cracks_->now()), row);
  }
  files_.add_layout_row(row, converted_);
  row.insert(row.end(), reactions_.now.begin(), reactions_.now.end());
  files_.history->row(row);
}

void Recorder::write_fields(const solve::Step& step, Vec u, const post::DisplacementError* error)
{
  std::vector<double> relative(static_cast<std::size_t>(files_.scene.mesh->owned_vertices()), 0.0);
  if (error) relative = error->relative_percent;
  files_.write_fields(step.load, u, relative);
}

std::string Recorder::said_so_far(const solve::StaticReport& report) const
{
  std::string text = fmt::format("{} linear iterations so far", report.linear_iterations);
  if (report.halvings > 0) text += fmt::format(", {} attempts given up", report.halvings);
  return files_.grows() ? fmt::format("{} bonds broken, {}", d_->fracture->broken(), text) : text;
}

void Recorder::working(const solve::StaticReport& report, double load)
{
  const int steps = options_.load.steps;
  files_.progress.step(static_cast<int>(load_ * steps + 1e-9), steps,
                       fmt::format("load {:.6g} being worked at, {}", load, said_so_far(report)));
}

void Recorder::accept(const solve::Step& step, Vec u, const solve::StaticSolver& driver, const Prior& prior)
{
  const double begin = MPI_Wtime();
  const bool last = step.load == 1.0;
  std::optional<post::DisplacementError> error;
  if (!prior.reference.empty() && last)
    error = post::compare_displacement(*files_.scene.mesh, d_->vertex_displacement(u), prior.reference);
  if (last && !ledger_) ledger_ = std::make_unique<post::EnergyLedger>(d_->system);
  if (ledger_) take_stock(step, u, driver);
  const bool looks = last || step.number % options_.output.history_interval == 0;
  load_ = step.load;
  if (looks) cracks_->look(*d_, load_);
  if (files_.history && looks) write_history(step, u);
  const bool due = last || step.number % options_.output.interval == 0;
  fields_due_ = due ? std::nullopt : std::optional(step);
  if (files_.fields && due) write_fields(step, u, error ? &*error : nullptr);
  files_.look_at_probes(step.number, step.load, u, last);
  if (files_.grows()) files_.summary.bonds_broken = d_->fracture->broken();
  if (last) write_results(u, prior, error ? &*error : nullptr);
  files_.summary.wall_seconds.output += MPI_Wtime() - begin;
  files_.summary.steps = step.number;
  std::string text = said_so_far(driver.report());
  if (files_.grows()) text = fmt::format("{} passes, {}", step.passes, text);
  if (driver.report().halvings > 0) text = fmt::format("load {:.6g}, {}", step.load, text);
  files_.progress.step(static_cast<int>(step.load * options_.load.steps + 1e-9), options_.load.steps, text);
}

void Recorder::write_results(Vec u, const Prior& prior, const post::DisplacementError* error)
{
  auto& results = files_.summary.results;
  if (error) {
    results["max_relative_error_percent"] = error->max_relative_percent;
    results["mean_relative_error_percent"] = error->mean_relative_percent;
    results["vector_l2_error_percent"] = error->vector_l2_percent;
    results["vector_max_error_percent"] = error->vector_max_percent;
  }
  const post::EnergyBalance& balance = ledger_->balance();
  results["strain_energy"] = balance.energies.elastic();
  results["strain_energy_elements"] = balance.energies.elements;
  results["strain_energy_bonds"] = balance.energies.bonds;
  results["strain_energy_interface"] = balance.energies.interface;
  if (d_->has_points()) {
    results["strain_energy_points"] = balance.energies.points;
    results["strain_energy_contact"] = balance.energies.contact;
  }
  if (!d_->supports.empty()) results["strain_energy_supports"] = balance.energies.supports;
  results["external_work"] = balance.work;
  if (files_.grows()) {
    results["fracture_energy"] = balance.energies.dissipated;
    if (!options_.thermal.active()) results["energy_balance_error"] = balance.error(); // heat is not in the books
    results["critical_stretch"] = d_->critical_stretch;
  }
  const std::vector<std::string> held = files_.held_names(), turned = files_.turned_names();
  for (std::size_t k = 0; k < turned.size(); ++k)
    results["reaction_moment"][turned[k]] = reactions_.now[2 * held.size() + k];
  for (std::size_t k = 0; k < held.size(); ++k) {
    const std::string& name = held[k];
    const double t = options_.elastic.thickness;
    results["reaction"][name] = {reactions_.now[2 * k], reactions_.now[2 * k + 1]};
    if (!files_.grows()) continue;
    results["peak_reaction"][name] = {reactions_.peak[2 * k], reactions_.peak[2 * k + 1]};
    results["peak_reaction_per_thickness"][name] = {reactions_.peak[2 * k] / t, reactions_.peak[2 * k + 1] / t};
    results["peak_reaction_load"][name] = {reactions_.peak_load[2 * k], reactions_.peak_load[2 * k + 1]};
  }
  PetscReal largest = 0.0;
  PDX_CALL(VecNorm(u, NORM_INFINITY, &largest));
  results["max_displacement_component"] = largest;
  cracks_->look(*d_, load_);
  cracks_->write_paths();
  cracks_->add_results(results);
  if (d_->cracks.empty() && !options_.post.any_j()) return;
  std::vector<double> local;
  d_->system.halo->gather(u, local);
  nlohmann::json cracks = nlohmann::json::object();
  const std::string missing = add_crack_results({*files_.scene.mesh, options_, *d_->patch_plan, *d_, local},
                                                cracks_->now(), prior.energy_release, cracks);
  for (const auto& [key, value] : cracks.items()) results[key] = value;
  if (missing.empty()) return;
  results["j_missing"] = missing;
  if (!options_.output.warnings_are_errors)
    files_.warn("no J at a tip where it has come to: " + missing); // all is done
}

void Recorder::tell_condensed(const solve::CondensationReport& report)
{
  files_.summary.results["static_condense"] =
      report.why_not.empty()
          ? fmt::format("on: {} unknowns of elements kept, {} eliminated", report.kept, report.eliminated)
          : fmt::format("off: {}", report.why_not);
}

void Recorder::count(const solve::StaticReport& report)
{
  files_.summary.wall_seconds.solve = report.seconds;
  if (files_.solved_before > 0.0) files_.summary.results["seconds_solved_before"] = files_.solved_before;
  files_.summary.newton_iterations = report.newton_iterations;
  files_.summary.linear_iterations = report.linear_iterations;
  files_.summary.jacobian_assemblies = report.jacobian_assemblies;
  files_.summary.factorizations = report.preconditioner_builds;
  auto& results = files_.summary.results;
  results["load_steps_accepted"] = report.steps;
  results["passes"] = report.passes;
  results["halvings"] = report.halvings;
  results["particles_held"] = report.held_rows;
  results["solve_iterations"] = series(report.solve_iterations);
  files_.add_layout_results(converted_, ledger_ ? ledger_->balance().work : 0.0);
  if (!files_.grows()) return;
  results["solve_seconds"] = series(report.solve_seconds);
  results["solve_bonds_broken"] = series(report.solve_changes);
}

void Recorder::finish(const solve::StaticReport& report)
{
  count(report);
  files_.warn(scene::size_warning(options_, files_.summary.results.at("max_displacement_component").get<double>(),
                                  files_.scene.mesh->bounds()));
  files_.write_summary("done");
  print_phases(report);
}

void Recorder::stopped_at(Vec u)
{
  if (files_.fields && fields_due_) write_fields(*fields_due_, u, nullptr);
  if (ledger_ && files_.summary.steps > 0) write_results(u, {}, nullptr);
}

RecorderNotes Recorder::notes() const
{
  RecorderNotes notes;
  if (cracks_) notes.marks = cracks_->marks();
  notes.numbers = {{"converted", converted_}, {"books", ledger_ != nullptr}};
  if (!ledger_) return notes;
  const post::EnergyBalance& balance = ledger_->balance();
  notes.numbers.merge(NamedNumbers{{"work", balance.work},
                                   {"energy_elements", balance.energies.elements},
                                   {"energy_bonds", balance.energies.bonds},
                                   {"energy_interface", balance.energies.interface},
                                   {"energy_points", balance.energies.points},
                                   {"energy_supports", balance.energies.supports},
                                   {"energy_contact", balance.energies.contact},
                                   {"dissipated", balance.energies.dissipated}});
  for (std::size_t k = 0; k < reactions_.now.size(); ++k) {
    notes.numbers[fmt::format("reaction_{}", k)] = reactions_.now[k];
    notes.numbers[fmt::format("peak_{}", k)] = reactions_.peak[k];
    notes.numbers[fmt::format("peak_load_{}", k)] = reactions_.peak_load[k];
  }
  return notes;
}

std::string Recorder::fault_of(const NamedNumbers& numbers)
{
  for (const char* name : {"converted", "books"})
    if (!numbers.contains(name)) return fmt::format("has no {}", name);
  if (numbers.at("books") == 0.0) return "";
  for (const char* name : {"work", "energy_elements", "energy_bonds", "energy_interface", "dissipated"})
    if (!numbers.contains(name)) return fmt::format("has no {}", name);
  return "";
}

void Recorder::take_notes(const RecorderNotes& notes, double load, std::vector<double> u,
                          std::span<const double> internal_force)
{
  const NamedNumbers& n = notes.numbers;
  converted_ = n.at("converted");
  load_ = load;
  files_.summary.steps = static_cast<int>(std::lround(n.at("step")));
  if (files_.grows()) files_.summary.bonds_broken = d_->fracture->broken();
  if (!cracks_->take_marks(notes.marks))
    throw UserError(fmt::format("cannot read '{}': it notes cracks that are not there, or not in order",
                                options_.time.checkpoint.restart));
  if (files_.grows()) cracks_->look(*d_, load_);
  if (n.at("books") == 0.0) return; // of no run whose bonds break, or that has a history
  post::EnergyBalance balance{n.at("work"), {}};
  balance.energies.elements = n.at("energy_elements");
  balance.energies.bonds = n.at("energy_bonds");
  balance.energies.interface = n.at("energy_interface");
  if (const auto points = n.find("energy_points"); points != n.end()) balance.energies.points = points->second;
  if (const auto supports = n.find("energy_supports"); supports != n.end())
    balance.energies.supports = supports->second;
  if (const auto contact = n.find("energy_contact"); contact != n.end()) balance.energies.contact = contact->second;
  balance.energies.dissipated = n.at("dissipated");
  ledger_ = std::make_unique<post::EnergyLedger>(
      d_->system, post::LedgerState{std::move(u), post::external_force(d_->system, load, internal_force), balance},
      load);
  const auto series = [&n](const char* name) {
    std::vector<double> values;
    for (auto at = n.find(fmt::format("{}_0", name)); at != n.end();
         at = n.find(fmt::format("{}_{}", name, values.size())))
      values.push_back(at->second);
    return values;
  };
  reactions_ = {series("reaction"), series("peak"), series("peak_load")};
  const std::size_t components = 2 * files_.held_names().size() + files_.turned_names().size();
  for (std::vector<double>* values : {&reactions_.now, &reactions_.peak, &reactions_.peak_load})
    values->resize(components, 0.0);
}

void Recorder::print_phases(const solve::StaticReport& report)
{
  const auto& seconds = files_.summary.wall_seconds;
  const double unknowns = static_cast<double>(files_.summary.unknowns.total());
  std::vector<io::Phase> phases{
      {"set-up", seconds.setup, ""},
      {"solve", seconds.solve,
       fmt::format("{:.3g} unknowns/s, {} linear iterations", unknowns * report.newton_iterations / seconds.solve,
                   report.linear_iterations)},
      {"output", seconds.output, ""}};
  if (files_.layout_seconds > 0.0) phases.push_back({"changes of layout", files_.layout_seconds, ""});
  if (files_.solved_before > 0.0)
    phases.insert(phases.begin() + 1,
                  {"solved before", files_.solved_before, "for the reference or the energy release"});
  files_.progress.phases(phases);
  if (const auto error = files_.summary.results.find("max_relative_error_percent");
      error != files_.summary.results.end())
    files_.progress.line(fmt::format("largest difference to elements only (Eq. 28): {:.4g} %", error->get<double>()));
  for (const std::string& line : tip_lines(files_.summary.results)) files_.progress.line(line);
  files_.progress.line(citation_line(options_));
}
} // namespace pdx::record
