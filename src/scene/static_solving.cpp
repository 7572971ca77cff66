#include "pdx/scene/static_solving.hpp"

#include "pdx/scene/support.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::scene {
bool wants_assembled(const options::SceneOptions& options)
{
  if (!options.pd.any() || options.points.any() || options.pd.solver == options::PdOperator::assembled) return true;
  for (const options::BoundaryCondition& c : options.conditions) {
    if (!c.rolls_slanted() && !c.springs && !c.pin)
      continue; // the coarse level of matrix-free solves knows held components only
    if (options.pd.solver == options::PdOperator::automatic) return true;
    throw UserError(fmt::format("-bc_{}_{} needs a matrix, but -pd_operator is matrix_free: use assembled, or drop it",
                                c.name,
                                c.springs ? "spring"
                                : c.pin   ? "pin"
                                          : "roller"));
  }
  char type[64] = "";
  PetscBool given = PETSC_FALSE;
  PDX_CALL(PetscOptionsGetString(nullptr, nullptr, "-pc_type", type, sizeof type, &given));
  if (!given || solve::works_matrix_free(type)) return false;
  if (options.pd.solver == options::PdOperator::automatic) return true;
  throw UserError(
      fmt::format("-pc_type {} needs a matrix, but -pd_operator is matrix_free: use assembled, or one of mg, "
                  "pbjacobi, jacobi, none",
                  type));
}

solve::StaticOptions static_options(const options::SceneOptions& options, const Discretisation& d, bool assembled)
{
  solve::StaticOptions steps;
  steps.load_steps = options.load.steps;
  steps.assembled = assembled;
  const bool pins = std::ranges::any_of(options.conditions, [](const auto& c) { return c.pin.has_value(); });
  steps.full_steps = d.touching != nullptr || pins;
  steps.condense = static_cast<solve::Condense>(options.load.condense); // of the same words
  steps.max_passes = options.load.passes;
  steps.max_halvings = options.load.halvings;
  if (!d.fracture) return steps;
  steps.max_changes =
      std::max<std::int64_t>(1, std::llround(options.load.broken_share * static_cast<double>(d.bonds_at_start)));
  Index family = 0; // as many particles may come off together
  for (const auto& part : d.bonds->parts())
    family = std::max(family, static_cast<Index>(2 * part->stencil().half.size()));
  steps.judge = [&parts = *d.loose_parts, family, &frame = options.frame] {
    require_support_after_breaking(parts, family, frame);
  };
  return steps;
}
} // namespace pdx::scene
