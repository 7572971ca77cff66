#include "pdx/app/recorder.hpp"

#include "pdx/app/crack_results.hpp"
#include "pdx/app/output_blocks.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/io/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace pdx::app {
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

Recorder::Recorder(MPI_Comm comm, const SceneOptions& options, double begin)
    : comm_(comm), options_(options), begin_(begin), progress_(comm, options.output.quiet)
{
  summary_.case_name = options.case_name;
  io::create_directory(comm, options.output.directory);
}

void Recorder::built(mesh::Mesh& mesh, const PatchPlan& plan, const Discretisation& d)
{
  mesh_ = &mesh;
  plan_ = &plan;
  d_ = &d;
  std::int64_t counts[3] = {2 * static_cast<std::int64_t>(d.nodes.size()),
                            2 * static_cast<std::int64_t>(d.system.rows.enriched),
                            2 * static_cast<std::int64_t>(d.particles.size())};
  MPI_Allreduce(MPI_IN_PLACE, counts, 3, MPI_INT64_T, MPI_SUM, comm_);
  summary_.unknowns.fe = counts[0];
  summary_.unknowns.enriched = counts[1];
  summary_.unknowns.pd = counts[2];
  summary_.unknowns.ghost = d.ghosts;
  summary_.partition.cut = mesh.quality().cut;
  summary_.partition.imbalance = mesh.quality().imbalance;
  summary_.partition.particles_per_rank = gather_all(comm_, std::vector<int>{static_cast<int>(d.particles.size())});
  progress_.line(fmt::format("{}: {} unknowns ({} of elements, {} of particles), partition cut {} imbalance {:.2f}",
                             options_.case_name, counts[0] + counts[1] + counts[2], counts[0] + counts[1], counts[2],
                             mesh.quality().cut, mesh.quality().imbalance));
  report_cracks();
  if (grows() || options_.output.history) ledger_ = std::make_unique<post::EnergyLedger>(d.system);
  if (options_.output.fields) fields_ = std::make_unique<io::FieldsFile>(comm_, options_.output.directory);
  if (options_.output.history) open_history();
}

void Recorder::report_cracks()
{
  if (!d_->sets) return;
  const xfem::CutReport& report = d_->sets->report();
  auto& results = summary_.results;
  results["cut_elements"] = report.cells;
  results["enriched_sets"] = report.sets;
  results["enriched_sets_dropped"] = report.dropped;
  if (report.dropped > 0)
    progress_.line(fmt::format("{} nodes of cut elements have no enriched row: less than {:g} of their support lies on "
                               "one side",
                               report.dropped, options_.cracks.rule.share()));
  if (options_.post.energy_release)
    for (const crack::Tip& tip : d_->cracks.tips())
      if (tip.direction.cwiseAbs().minCoeff() > 1e-9)
        warn(fmt::format("-post_energy_release at the slanted tip ({:g}, {:g}): bonds end at lattice sites, so that a "
                         "step of one spacing is not one of the crack; expect differences of several per cent",
                         tip.at[0], tip.at[1]));
  for (const Vector<2>& tip : report.closed)
    warn(fmt::format("the crack tip at ({:g}, {:g}) ends in elements and closes at the last element edge before it: "
                     "put a patch there for a true tip",
                     tip[0], tip[1]));
}

void Recorder::open_history()
{
  std::vector<io::Column> columns{
      {"step", "-"}, {"load", "-"}, {"energy_elements", "J"}, {"energy_bonds", "J"}, {"energy_interface", "J"},
      {"work", "J"}};
  if (grows())
    columns.insert(columns.end(), {{"energy_fracture", "J"},
                                   {"passes", "-"},
                                   {"bonds_broken", "-"},
                                   {"crack_length", "m"},
                                   {"crack_first_intact", "m"},
                                   {"crack_farthest_broken", "m"}});
  for (std::size_t t = 0; grows() && t < d_->cracks.tips().size(); ++t) {
    columns.push_back({fmt::format("tip{}_x", t + 1), "m"});
    columns.push_back({fmt::format("tip{}_y", t + 1), "m"});
  }
  for (const HeldPart& part : d_->held_parts) {
    columns.push_back({"reaction_" + part.name + "_x", "N"});
    columns.push_back({"reaction_" + part.name + "_y", "N"});
  }
  history_ =
      std::make_unique<io::Curve>(comm_, std::filesystem::path(options_.output.directory) / "history.csv", columns);
}

void Recorder::started()
{
  summary_.wall_seconds.setup = MPI_Wtime() - begin_;
  summary_.memory_mb["before_solve"] = io::resident_memory_mb();
}

/// Energies, work and reactions at an accepted load.
void Recorder::take_stock(const solve::Step& step, Vec u, const solve::StaticDriver& driver)
{
  std::vector<double> local, force = driver.unbalanced_force(u, step.load); // reactions where held
  d_->system.halo->gather(u, local);
  post::Energies mine;
  if (d_->elements) mine.elements += d_->elements->energy(local);
  if (d_->cut_elements) mine.elements += d_->cut_elements->energy(local);
  if (d_->bonds) mine.bonds = d_->bonds->energy(local);
  if (d_->carried) mine.interface = d_->carried->energy(local);
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (grows() && rank == 0) mine.dissipated = d_->fracture->dissipated();

  reactions_.now.assign(2 * d_->held_parts.size(), 0.0);
  for (std::size_t p = 0; p < d_->held_parts.size(); ++p)
    for (const Index k : d_->held_parts[p].components)
      if (k / 2 < d_->system.rows.nodes || k / 2 >= d_->system.rows.first_particle()) // forces of sets are none
        reactions_.now[2 * p + static_cast<std::size_t>(k % 2)] += force[static_cast<std::size_t>(k)];
  MPI_Allreduce(MPI_IN_PLACE, reactions_.now.data(), static_cast<int>(reactions_.now.size()), MPI_DOUBLE, MPI_SUM,
                comm_);
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

void Recorder::write_history(const solve::Step& step)
{
  const post::EnergyBalance& balance = ledger_->balance();
  std::vector<double> row{static_cast<double>(step.number), step.load,
                          balance.energies.elements,        balance.energies.bonds,
                          balance.energies.interface,       balance.work};
  if (grows()) {
    const CrackState crack = crack_state(*d_);
    const bool tip = !crack.first_intact.empty(); // the columns are those of the first tip
    const double first = tip ? length_inside(*d_, d_->cracks.tips()[0].crack) : 0.0;
    row.insert(row.end(),
               {balance.energies.dissipated, static_cast<double>(step.passes),
                static_cast<double>(d_->fracture->broken()), crack.length, tip ? first + crack.first_intact[0] : first,
                tip ? first + crack.farthest_broken[0] : first});
    for (std::size_t t = 0; t < crack.farthest_broken.size(); ++t) {
      const crack::Tip& given = d_->cracks.tips()[t];
      const Vector<2> at = given.at + crack.farthest_broken[t] * given.direction;
      row.insert(row.end(), {at[0], at[1]});
    }
  }
  row.insert(row.end(), reactions_.now.begin(), reactions_.now.end());
  history_->row(row);
}

void Recorder::write_fields(const solve::Step& step, Vec u, const post::DisplacementError* error)
{
  std::vector<double> relative(static_cast<std::size_t>(mesh_->owned_vertices()), 0.0);
  if (error) relative = error->relative_percent;
  fields_->write(step.load, output_blocks(*mesh_, options_, *plan_, *d_, u, relative));
}

void Recorder::accept(const solve::Step& step, Vec u, const solve::StaticDriver& driver, const Prior& prior)
{
  const double begin = MPI_Wtime();
  const bool last = step.load == 1.0;
  std::optional<post::DisplacementError> error;
  if (!prior.reference.empty() && last)
    error = post::compare_displacement(*mesh_, d_->vertex_displacement(u), prior.reference);
  if (last && !ledger_) ledger_ = std::make_unique<post::EnergyLedger>(d_->system);
  if (ledger_) take_stock(step, u, driver);
  if (history_) write_history(step);
  const bool due = last || step.number % options_.output.interval == 0;
  fields_due_ = due ? std::nullopt : std::optional(step);
  if (fields_ && due) write_fields(step, u, error ? &*error : nullptr);
  if (grows()) summary_.bonds_broken = d_->fracture->broken();
  if (last) write_results(u, prior, error ? &*error : nullptr);
  summary_.wall_seconds.output += MPI_Wtime() - begin;
  summary_.steps = step.number;
  std::string text = fmt::format("{} linear iterations so far", driver.report().linear_iterations);
  if (grows()) text = fmt::format("{} passes, {} bonds broken, {}", step.passes, d_->fracture->broken(), text);
  if (driver.report().halvings > 0) text = fmt::format("load {:.6g}, {}", step.load, text);
  progress_.step(static_cast<int>(step.load * options_.load.steps + 1e-9), options_.load.steps, text);
}

void Recorder::write_results(Vec u, const Prior& prior, const post::DisplacementError* error)
{
  auto& results = summary_.results;
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
  results["external_work"] = balance.work;
  if (grows()) {
    results["fracture_energy"] = balance.energies.dissipated;
    results["energy_balance_error"] = balance.error();
    results["critical_stretch"] = d_->critical_stretch;
  }
  for (std::size_t k = 0; k < d_->held_parts.size(); ++k) {
    const std::string& name = d_->held_parts[k].name;
    const double t = options_.elastic.thickness;
    results["reaction"][name] = {reactions_.now[2 * k], reactions_.now[2 * k + 1]};
    if (!grows()) continue;
    results["peak_reaction"][name] = {reactions_.peak[2 * k], reactions_.peak[2 * k + 1]};
    results["peak_reaction_per_thickness"][name] = {reactions_.peak[2 * k] / t, reactions_.peak[2 * k + 1] / t};
    results["peak_reaction_load"][name] = {reactions_.peak_load[2 * k], reactions_.peak_load[2 * k + 1]};
  }
  PetscReal largest = 0.0;
  PDX_CALL(VecNorm(u, NORM_INFINITY, &largest));
  results["max_displacement_component"] = largest;
  if (d_->cracks.empty() && !options_.post.any_j()) return;
  std::vector<double> local;
  d_->system.halo->gather(u, local);
  nlohmann::json cracks = nlohmann::json::object();
  add_crack_results({*mesh_, options_, *plan_, *d_, local}, prior.energy_release, cracks);
  for (const auto& [key, value] : cracks.items()) results[key] = value;
}

void Recorder::count(const solve::StaticReport& report)
{
  summary_.wall_seconds.solve = report.seconds;
  summary_.newton_iterations = report.newton_iterations;
  summary_.linear_iterations = report.linear_iterations;
  summary_.jacobian_assemblies = report.jacobian_assemblies;
  summary_.factorizations = report.preconditioner_builds;
  auto& results = summary_.results;
  results["load_steps_accepted"] = report.steps;
  results["passes"] = report.passes;
  results["halvings"] = report.halvings;
  results["particles_held"] = report.held_rows;
  results["solve_iterations"] = series(report.solve_iterations);
  if (!grows()) return;
  results["solve_seconds"] = series(report.solve_seconds);
  results["solve_bonds_broken"] = series(report.solve_changes);
}

void Recorder::finish(const solve::StaticReport& report)
{
  count(report);
  write_summary("done");
  print_phases(report);
}

void Recorder::stopped_at(Vec u)
{
  if (fields_ && fields_due_) write_fields(*fields_due_, u, nullptr);
  if (ledger_ && summary_.steps > 0) write_results(u, {}, nullptr);
}

void Recorder::fail(const std::string& why)
{
  summary_.message = why;
  write_summary("failed");
}

void Recorder::warn(const std::string& what)
{
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  if (rank == 0) fmt::print(stderr, "warning: {}\n", what);
}

void Recorder::write_summary(const char* status)
{
  summary_.status = status;
  summary_.events = io::gather_event_counts(comm_);
  summary_.wall_seconds.total = MPI_Wtime() - begin_;
  io::write_summary(comm_, std::filesystem::path(options_.output.directory) / "summary.json", summary_);
}

void Recorder::print_phases(const solve::StaticReport& report)
{
  const auto& seconds = summary_.wall_seconds;
  const double unknowns = static_cast<double>(summary_.unknowns.total());
  const std::vector<io::Phase> phases{
      {"set-up", seconds.setup, ""},
      {"solve", seconds.solve,
       fmt::format("{:.3g} unknowns/s, {} linear iterations", unknowns * report.newton_iterations / seconds.solve,
                   report.linear_iterations)},
      {"output", seconds.output, ""}};
  progress_.phases(phases);
  if (const auto error = summary_.results.find("max_relative_error_percent"); error != summary_.results.end())
    progress_.line(fmt::format("largest difference to elements only (Eq. 28): {:.4g} %", error->get<double>()));
}
} // namespace pdx::app
