#include "pdx/io/summary.hpp"

#include "pdx/base/events.hpp"
#include "pdx/io/provenance.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <petscversion.h>
#include <sstream>
#include <string_view>

namespace pdx::io {
namespace {
using Json = nlohmann::ordered_json;

/// A line "Key:   123 kB" of this process's status file [MB].
double status_mb(std::string_view key)
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return std::stod(line.substr(key.size())) * 1024.0 / 1e6;
  return 0.0;
}

/// All ranks' texts, one after the other.
std::string gather_text(MPI_Comm comm, const std::string& mine)
{
  int size = 0;
  MPI_Comm_size(comm, &size);
  int length = static_cast<int>(mine.size());
  std::vector<int> lengths(static_cast<std::size_t>(size)), starts(static_cast<std::size_t>(size), 0);
  MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, comm);
  for (std::size_t r = 1; r < starts.size(); ++r) starts[r] = starts[r - 1] + lengths[r - 1];
  std::string all(static_cast<std::size_t>(starts.back() + lengths.back()), ' ');
  MPI_Allgatherv(mine.data(), length, MPI_CHAR, all.data(), lengths.data(), starts.data(), MPI_CHAR, comm);
  return all;
}

Json partition_json(const Summary::Partition& partition)
{
  Json json;
  json["cut"] = partition.cut ? Json(*partition.cut) : Json();
  json["imbalance"] = partition.imbalance;
  json["particles_per_rank"] = partition.particles_per_rank;
  return json;
}

void add_counts(Json& json, const Summary& summary)
{
  const auto& wall = summary.wall_seconds;
  json["wall_seconds"] = {{"total", wall.total}, {"setup", wall.setup}, {"solve", wall.solve}, {"output", wall.output}};
  const auto& rows = summary.unknowns;
  json["unknowns"] = {{"fe", rows.fe},       {"enriched", rows.enriched}, {"pd", rows.pd},
                      {"ghost", rows.ghost}, {"mpm", rows.mpm},           {"total", rows.total()}};
  json["steps"] = summary.steps;
  json["newton_iterations"] = summary.newton_iterations;
  json["linear_iterations"] = summary.linear_iterations;
  json["jacobian_assemblies"] = summary.jacobian_assemblies;
  json["factorizations"] = summary.factorizations;
  json["bonds_broken"] = summary.bonds_broken;
  json["relocations"] = summary.relocations;
  json["events"] = summary.events;
}
} // namespace

std::map<std::string, int> gather_event_counts(MPI_Comm comm)
{
  std::string mine;
  for (const auto& [name, event] : event_counts()) mine += fmt::format("{} {}\n", name, event.count);
  std::istringstream all(gather_text(comm, mine));
  std::map<std::string, int> largest;
  std::string name;
  for (int count = 0; all >> name >> count;) largest[name] = std::max(largest[name], count);
  return largest;
}

double resident_memory_mb() { return status_mb("VmRSS:"); }

double peak_memory_mb(MPI_Comm comm)
{
  double peak = status_mb("VmHWM:");
  MPI_Allreduce(MPI_IN_PLACE, &peak, 1, MPI_DOUBLE, MPI_MAX, comm);
  return peak;
}

namespace {
int ranks_of(MPI_Comm comm)
{
  int ranks = 0;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

Json provenance_json(MPI_Comm comm, const Summary& summary)
{
  Json json;
  for (const auto& [name, value] : provenance(comm)) json[name] = value;
  json["ranks"] = ranks_of(comm);
  json["hosts"] = summary.hosts;
  return json;
}

Json json_of(MPI_Comm comm, const Summary& summary, double peak)
{
  Json json;
  json["case"] = summary.case_name;
  json["version"] = PDX_VERSION;
  json["petsc_version"] = fmt::format("{}.{}.{}", PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
  json["ranks"] = ranks_of(comm);
  json["provenance"] = provenance_json(comm, summary);
  json["status"] = summary.status;
  json["message"] = summary.message;
  json["warnings"] = summary.warnings;
  add_counts(json, summary);
  json["partition"] = partition_json(summary.partition);
  json["peak_memory_mb"] = peak;
  if (!summary.memory_mb.empty()) json["memory_mb"] = summary.memory_mb;
  json["results"] = summary.results;
  return json;
}

std::string text_of(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }
} // namespace

Json summary_json(MPI_Comm comm, const Summary& summary) { return json_of(comm, summary, peak_memory_mb(comm)); }

Fault write_summary_alone(MPI_Comm comm, const std::filesystem::path& path, const Summary& summary)
{
  return replace_file_alone(path, text_of(json_of(comm, summary, status_mb("VmHWM:"))));
}

void write_summary(MPI_Comm comm, const std::filesystem::path& path, const Summary& summary)
{
  const Json json = summary_json(comm, summary);
  replace_file(comm, path, text_of(json));
}
} // namespace pdx::io
