#include "pdx/app/run.hpp"

#include "pdx/app/run_in_time.hpp"
#include "pdx/app/run_static.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/memory.hpp"
#include "pdx/base/options.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/scene/mixed_points.hpp"
#include "pdx/scene/scene_warnings.hpp"
#include "pdx/scene/settle.hpp"
#include "pdx/scene/static_solving.hpp"

#include <new>

namespace pdx::app {
namespace {
/// Names of PETSc options that nothing has used, a misspelt one perhaps.
std::string unused_options()
{
  PetscInt count = 0;
  char **names = nullptr, **values = nullptr;
  std::string list;
  PDX_CALL(PetscOptionsLeftGet(nullptr, &count, &names, &values));
  for (PetscInt k = 0; k < count; ++k) {
    const std::string name = std::string("-") + names[k];
    if (is_petsc_family(name) && !is_documented(name)) list += (list.empty() ? "" : ", ") + name;
  }
  PDX_CALL(PetscOptionsLeftRestore(nullptr, &count, &names, &values));
  return list;
}

void refuse_reference_options(const options::SceneOptions& options)
{
  if (options.post.reference_fe && !options.pd.any())
    throw UserError("-post_reference_fe compares with the same scene without patches, but there are none: drop it");
}
} // namespace

void run(MPI_Comm comm, double begin)
{
  options::SceneOptions options = options::SceneOptions::read();
  refuse_reference_options(options);
  if (!options.time.dynamic()) (void)scene::wants_assembled(options); // refuses before anything is built
  scene::settle(comm, options);
  if (options.output.dry_run) { // what rests now will move
    options.pd.skip_tolerance = -1.0;
    options.points.skips_rest = false;
  }
  record::RunFiles files(comm, options, begin);
  std::vector<std::string> warnings = scene::option_warnings(options);
  warnings.insert(warnings.begin(), options.warnings.begin(), options.warnings.end());
  files.warn_later(std::move(warnings));
  for (const std::string& note : options.notes) files.progress.line(note);
  try {
    if (options.time.dynamic())
      run_in_time(files, scene::scene_in_time(comm, options));
    else
      run_static(files, options.mixed() ? scene::settle_mixed(comm, options) : nullptr);
    if (const std::string unused = unused_options(); !unused.empty())
      files.warn("options of PETSc that nothing used: " + unused);
  } catch (const UserError&) {
    throw;
  } catch (const SolverFailure& failure) {
    files.fail(failure.what());
    throw;
  } catch (const Stopped& stop) {
    files.stop(stop.what());
  } catch (const std::bad_alloc&) {
    files.lost(memory_ran_out());
    throw;
  } catch (const std::exception& failure) {
    files.lost(failure.what());
    throw;
  }
}
} // namespace pdx::app
