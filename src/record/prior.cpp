#include "pdx/record/prior.hpp"

#include "pdx/base/events.hpp"
#include "pdx/scene/static_solving.hpp"

#include <fmt/format.h>

namespace pdx::record {
std::vector<double> reference_displacement(mesh::Mesh& mesh, const options::SceneOptions& options)
{
  const PauseCounts pause;
  options::SceneOptions unbroken = options;
  unbroken.fracture = {};
  scene::PatchPlan whole;
  whole.body = options.mesh.box;
  const auto d = scene::discretise(mesh, unbroken, whole, {}, true);
  solve::StaticDriver driver(d->system, scene::static_options(unbroken, *d, true));
  const VecHandle u = d->system.rows.vector();
  try {
    driver.run(u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
  } catch (const SolverFailure& failure) {
    throw SolverFailure(fmt::format("the elements-only reference (-post_reference_fe): {}", failure.what()));
  }
  mesh.uncover();
  return d->vertex_displacement(u.get());
}
} // namespace pdx::record
