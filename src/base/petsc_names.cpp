#include "pdx/base/petsc_names.hpp"

#include <algorithm>
#include <array>

namespace pdx {
namespace {
/// Beginnings of names that objects of PETSc look for; of one that none looks for the run warns at its end.
constexpr std::array<std::string_view, 23> kFamilies{
    "snes_",   "ksp_",       "pc_",   "mg_",   "mat_", "vec_",    "vecscatter_",       "ts_",
    "tao_",    "dm_",        "sf_",   "is_",   "sub_", "viewer_", "petscpartitioner_", "x_",
    "esteig_", "redundant_", "draw_", "cuda_", "hip_", "device_", "fieldsplit_"};

/// What PETSc reads as it starts or ends, when nobody would tell of a misspelt one.
constexpr std::array<std::string_view, 50> kNames{"check_pointer_intensity",
                                                  "citations",
                                                  "debug_terminal",
                                                  "debugger_nodes",
                                                  "debugger_pause",
                                                  "debugger_ranks",
                                                  "error_output_none",
                                                  "error_output_stdout",
                                                  "fp_trap",
                                                  "get_total_flops",
                                                  "info",
                                                  "log",
                                                  "log_all",
                                                  "log_exclude",
                                                  "log_include",
                                                  "log_mpe",
                                                  "log_nvtx",
                                                  "log_perfstubs",
                                                  "log_summary",
                                                  "log_sync",
                                                  "log_trace",
                                                  "log_view",
                                                  "log_view_gpu_time",
                                                  "log_view_memory",
                                                  "malloc",
                                                  "malloc_clear",
                                                  "malloc_coalesce",
                                                  "malloc_debug",
                                                  "malloc_dump",
                                                  "malloc_hbw",
                                                  "malloc_requested_size",
                                                  "malloc_test",
                                                  "malloc_view",
                                                  "malloc_view_threshold",
                                                  "memory_view",
                                                  "no_signal_handler",
                                                  "not_shared_tmp",
                                                  "nox",
                                                  "nox_warning",
                                                  "objects_dump",
                                                  "on_error_abort",
                                                  "on_error_attach_debugger",
                                                  "on_error_mpiabort",
                                                  "options_left",
                                                  "options_monitor",
                                                  "options_view",
                                                  "shared_tmp",
                                                  "start_in_debugger",
                                                  "stop_for_debugger",
                                                  "use_gpu_aware_mpi"};
static_assert(std::ranges::is_sorted(kNames));
} // namespace

bool is_petsc_family(std::string_view name)
{
  if (!name.starts_with('-')) return false;
  name.remove_prefix(1);
  return std::ranges::any_of(kFamilies, [&](std::string_view family) { return name.starts_with(family); });
}

bool is_petsc_name(std::string_view name)
{
  return is_petsc_family(name) || (name.starts_with('-') && std::ranges::binary_search(kNames, name.substr(1)));
}
} // namespace pdx
