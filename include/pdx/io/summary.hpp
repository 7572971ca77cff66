#pragma once
#include "pdx/io/agree.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <mpi.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace pdx::io {
/// What a run was and what came out of it: the content of `summary.json`, filled by the application.
struct Summary {
  struct WallSeconds { ///< [s]
    double total = 0.0, setup = 0.0, solve = 0.0, output = 0.0;
  };
  struct Unknowns { ///< rows x Dim of all ranks; `ghost` and `mpm` count points
    std::int64_t fe = 0, enriched = 0, pd = 0, ghost = 0, mpm = 0;
    std::int64_t total() const { return fe + enriched + pd; }
  };
  struct Partition {
    std::optional<double> cut;           ///< edges of the cell graph between ranks [-]
    double imbalance = 1.0;              ///< largest over mean load of a rank [-]
    std::vector<int> particles_per_rank; ///< one per rank
  };

  std::string case_name;
  std::string status = "running"; ///< "done", "failed", ...
  std::string message;            ///< empty, or why the run failed
  std::vector<std::string> warnings;
  WallSeconds wall_seconds;
  Unknowns unknowns;
  int hosts = 1; ///< that the ranks are on
  std::int64_t steps = 0, newton_iterations = 0, linear_iterations = 0;
  std::int64_t jacobian_assemblies = 0, factorizations = 0, bonds_broken = 0, relocations = 0;
  std::map<std::string, int> events; ///< counts by event name, see gather_event_counts
  Partition partition;
  std::map<std::string, double> memory_mb; ///< resident memory at named moments [MB]; left out if empty
  nlohmann::ordered_json results = nlohmann::ordered_json::object(); ///< named scalars and short tables, SI
};

/// Counts of our log events, the largest over the ranks: some ranks may have nothing to do. Collective.
std::map<std::string, int> gather_event_counts(MPI_Comm comm);
/// Memory this process has now [MB = 1e6 B]; 0 where the system does not tell.
double resident_memory_mb();
/// The most memory any rank ever had [MB = 1e6 B]. Collective.
double peak_memory_mb(MPI_Comm comm);

/// The summary as JSON, with version, PETSc version, ranks and peak memory added. Numbers that are not finite
/// become null. Collective.
nlohmann::ordered_json summary_json(MPI_Comm comm, const Summary& summary);
/// Writes or replaces the file in one stroke; rank 0's summary counts. Throws MachineFailure on every rank if it
/// cannot. Collective.
void write_summary(MPI_Comm comm, const std::filesystem::path& path, const Summary& summary);
/// The same by this process alone, of its own memory, for when others may not answer.
Fault write_summary_alone(MPI_Comm comm, const std::filesystem::path& path, const Summary& summary);
} // namespace pdx::io
