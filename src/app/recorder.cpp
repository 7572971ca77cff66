#include "pdx/app/recorder.hpp"

#include "pdx/app/output_blocks.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/io/agree.hpp"

#include <fmt/format.h>

namespace pdx::app {
Recorder::Recorder(MPI_Comm comm, const SceneOptions& options, double begin)
    : comm_(comm), options_(options), begin_(begin), progress_(comm, options.output.quiet)
{
  summary_.case_name = options.case_name;
  io::create_directory(comm, options.output.directory);
}

void Recorder::built(const mesh::Mesh& mesh, const PatchPlan& plan, const Discretisation& d)
{
  mesh_ = &mesh;
  plan_ = &plan;
  d_ = &d;
  std::int64_t counts[2] = {2 * static_cast<std::int64_t>(d.nodes.size()),
                            2 * static_cast<std::int64_t>(d.particles.size())};
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, comm_);
  summary_.unknowns.fe = counts[0];
  summary_.unknowns.pd = counts[1];
  summary_.unknowns.ghost = d.ghosts;
  summary_.partition.cut = mesh.quality().cut;
  summary_.partition.imbalance = mesh.quality().imbalance;
  summary_.partition.particles_per_rank = gather_all(comm_, std::vector<int>{static_cast<int>(d.particles.size())});
  progress_.line(fmt::format("{}: {} unknowns ({} of elements, {} of particles), partition cut {} imbalance {:.2f}",
                             options_.case_name, counts[0] + counts[1], counts[0], counts[1], mesh.quality().cut,
                             mesh.quality().imbalance));
  if (options_.output.fields) fields_ = std::make_unique<io::FieldsFile>(comm_, options_.output.directory);
  if (options_.output.history) open_history();
}

void Recorder::open_history()
{
  std::vector<io::Column> columns{
      {"step", "-"}, {"load", "-"}, {"energy_elements", "J"}, {"energy_bonds", "J"}, {"energy_interface", "J"}};
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

std::vector<double> Recorder::energies(Vec u) const
{
  std::vector<double> local, sums(3, 0.0);
  d_->system.halo->gather(u, local);
  if (d_->elements) sums[0] = d_->elements->energy(local);
  if (d_->bonds) sums[1] = d_->bonds->energy(local);
  if (d_->carried) sums[2] = d_->carried->energy(local);
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), 3, MPI_DOUBLE, MPI_SUM, comm_);
  return sums;
}

std::vector<double> Recorder::reactions(Vec u, const solve::StaticDriver& driver, double load) const
{
  const std::vector<double> force = driver.unbalanced_force(u, load);
  std::vector<double> sums;
  for (const HeldPart& part : d_->held_parts) {
    sums.resize(sums.size() + 2, 0.0);
    for (const Index k : part.components)
      sums[sums.size() - 2 + static_cast<std::size_t>(k % 2)] += force[static_cast<std::size_t>(k)];
  }
  MPI_Allreduce(MPI_IN_PLACE, sums.data(), static_cast<int>(sums.size()), MPI_DOUBLE, MPI_SUM, comm_);
  return sums;
}

void Recorder::write_history(int step, Vec u, const solve::StaticDriver& driver)
{
  const double load = static_cast<double>(step) / options_.load_steps;
  std::vector<double> row{static_cast<double>(step), load};
  for (const double energy : energies(u)) row.push_back(energy);
  for (const double reaction : reactions(u, driver, load)) row.push_back(reaction);
  history_->row(row);
}

void Recorder::accept(int step, Vec u, const solve::StaticDriver& driver, const std::vector<double>& reference)
{
  const double begin = MPI_Wtime();
  const bool last = step == options_.load_steps;
  std::optional<post::DisplacementError> error;
  if (!reference.empty() && last) error = post::compare_displacement(*mesh_, d_->vertex_displacement(u), reference);
  if (history_) write_history(step, u, driver);
  if (fields_) {
    std::vector<double> relative(static_cast<std::size_t>(mesh_->owned_vertices()), 0.0);
    if (error) relative = error->relative_percent;
    fields_->write(static_cast<double>(step) / options_.load_steps,
                   output_blocks(*mesh_, options_, *plan_, *d_, u, relative));
  }
  if (last) write_results(u, driver, error ? &*error : nullptr);
  summary_.wall_seconds.output += MPI_Wtime() - begin;
  summary_.steps = step;
  progress_.step(step, options_.load_steps,
                 fmt::format("{} linear iterations so far", driver.report().linear_iterations));
}

void Recorder::write_results(Vec u, const solve::StaticDriver& driver, const post::DisplacementError* error)
{
  auto& results = summary_.results;
  if (error) {
    results["max_relative_error_percent"] = error->max_relative_percent;
    results["mean_relative_error_percent"] = error->mean_relative_percent;
    results["vector_l2_error_percent"] = error->vector_l2_percent;
    results["vector_max_error_percent"] = error->vector_max_percent;
  }
  const std::vector<double> energy = energies(u);
  results["strain_energy"] = energy[0] + energy[1] + energy[2];
  results["strain_energy_elements"] = energy[0];
  results["strain_energy_bonds"] = energy[1];
  results["strain_energy_interface"] = energy[2];
  const std::vector<double> reaction = reactions(u, driver, 1.0);
  for (std::size_t k = 0; k < d_->held_parts.size(); ++k)
    results["reaction"][d_->held_parts[k].name] = {reaction[2 * k], reaction[2 * k + 1]};
  PetscReal largest = 0.0;
  PDX_CALL(VecNorm(u, NORM_INFINITY, &largest));
  results["max_displacement_component"] = largest;
}

void Recorder::count(const solve::StaticReport& report)
{
  summary_.wall_seconds.solve = report.seconds;
  summary_.newton_iterations = report.newton_iterations;
  summary_.linear_iterations = report.linear_iterations;
  summary_.jacobian_assemblies = report.jacobian_assemblies;
  summary_.factorizations = report.preconditioner_builds;
}

void Recorder::finish(const solve::StaticReport& report)
{
  count(report);
  write_summary("done");
  print_phases(report);
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
