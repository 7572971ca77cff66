#include "pdx/record/dry_run.hpp"

#include <cmath>
#include <fmt/format.h>

namespace pdx::record {
namespace {
constexpr double kEnough = 2.0;        // [s] of steps
constexpr int kLeast = 3, kMost = 200; // steps, whatever they take

std::string amount(double bytes)
{
  for (const auto& [size, name] : {std::pair(1e9, "GB"), std::pair(1e6, "MB")})
    if (bytes >= size) return fmt::format("{:.3g} {}", bytes / size, name);
  return fmt::format("{:.3g} kB", bytes / 1e3);
}
} // namespace

double DryRun::slowest(double seconds) const
{
  MPI_Allreduce(MPI_IN_PLACE, &seconds, 1, MPI_DOUBLE, MPI_MAX, files_.comm());
  return seconds;
}

void DryRun::fields(double time, Vec u)
{
  const double begin = MPI_Wtime();
  std::vector<double> none(static_cast<std::size_t>(files_.scene.mesh->owned_vertices()), 0.0);
  files_.write_fields(time, u, none);
  picture_ = slowest(MPI_Wtime() - begin);
  std::error_code unknown;
  const auto size =
      std::filesystem::file_size(std::filesystem::path(files_.options.output.directory) / "fields.h5", unknown);
  bytes_ = unknown ? 0.0 : static_cast<double>(size);
  staying_ = static_cast<double>(files_.fields->bytes_that_stay());
  begin_ = MPI_Wtime();
}

bool DryRun::step()
{
  last_ = slowest(MPI_Wtime() - begin_);
  if (++steps_ == 1) first_ = last_;
  return steps_ < kLeast || (steps_ < kMost && last_ < kEnough);
}

/// Sets of fields that the run would write.
double DryRun::pictures(int steps) const
{
  const options::OutputOptions& output = files_.options.output;
  return output.pictures
             ? std::ceil(static_cast<double>(steps) / output.interval) + static_cast<double>(output.times.size())
             : 0.0;
}

void DryRun::tell_time(int steps, double length)
{
  const options::OutputOptions& output = files_.options.output;
  const double each = steps_ > 1 ? (last_ - first_) / (steps_ - 1) : last_;
  const bool looks = output.history || files_.scene.model->breaker;
  auto& results = files_.summary.results;
  results["step_length"] = length;
  results["steps"] = steps;
  results["seconds_per_step"] = each;
  results["steps_timed"] = steps_;
  files_.progress.line(
      fmt::format("a step of {:.4g} s takes {:.3g} s, the mean of {}{}", length, each, std::max(1, steps_ - 1),
                  files_.summary.unknowns.pd > 0 ? ", none of its bonds left out; what rests will take less" : ""));
  tell({{fmt::format("{} steps", steps), static_cast<double>(steps), each},
        {"energies", looks ? std::floor(static_cast<double>(steps) / output.history_interval) : 0.0, look_},
        {"fields", pictures(steps), picture_}},
       files_.options.layout.patches_move() ? "with patches as large as at the start, " : "");
}

void DryRun::tell_loads(int loads, int iterations)
{
  auto& results = files_.summary.results;
  results["loads"] = loads;
  results["seconds_per_solve"] = solve_;
  results["linear_iterations_per_solve"] = iterations;
  files_.progress.line(
      fmt::format("a solve takes {:.3g} s and {} linear iterations: of the first load, whole", solve_, iterations));
  tell({{fmt::format("{} load{}", loads, loads == 1 ? "" : "s"), static_cast<double>(loads), solve_},
        {"fields", pictures(loads), picture_}},
       files_.grows() ? "with one solve a load, of which breaking takes more, " : "");
}

void DryRun::tell(const std::vector<Cost>& costs, const std::string& bound)
{
  const double mine = io::resident_memory_mb();
  double most = mine, all = mine, total = slowest(files_.summary.wall_seconds.setup);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, files_.comm());
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_DOUBLE, MPI_SUM, files_.comm());
  std::string parts = fmt::format("set-up {}", io::duration(total));
  for (const Cost& cost : costs) {
    total += cost.count * cost.seconds;
    if (cost.count > 0.0) parts += fmt::format(", {} {}", cost.name, io::duration(cost.count * cost.seconds));
  }
  const double sets = costs.back().count;
  if (sets > 1.0 && !files_.options.layout.patches_move()) bytes_ -= staying_ * (sets - 1.0) / sets;
  const auto ranks = files_.summary.partition.particles_per_rank.size();
  files_.progress.line(fmt::format("memory: {:.0f} MB on the rank that has most, {:.0f} MB on all", most, all));
  if (sets > 0.0)
    files_.progress.line(
        fmt::format("fields.h5: {:.0f} sets of {}, {} in all", sets, amount(bytes_), amount(sets * bytes_)));
  files_.progress.line(fmt::format("the run on {} rank{}: {}about {} ({})", ranks, ranks == 1 ? "" : "s", bound,
                                   io::duration(total), parts));
  auto& results = files_.summary.results;
  results["memory_mb_largest"] = most;
  results["memory_mb_all"] = all;
  results["field_sets"] = sets;
  results["seconds_per_field_set"] = picture_;
  results["bytes_per_field_set"] = bytes_;
  results["estimated_seconds"] = total;
  files_.write_summary("dry run");
}
} // namespace pdx::record
