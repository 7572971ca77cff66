#pragma once
#include "support/scene.hpp"

#include <random>

namespace pdx::test {
/// A displacement on either side of a scene's first crack.
struct SidedField {
  Field plus, minus;
};

/// The side with which a vertex moves: of those of cut cells its own, to the mesh's tolerance; without a set that of
/// the cells that snapped around it.
inline int node_side(Scene& scene, Index vertex)
{
  std::optional<xfem::Side> side;
  for (const xfem::CutElement& cut : scene.d().sets->cells())
    for (std::size_t a = 0; a < 4; ++a) {
      if (scene.mesh().cell(cut.cell)[a] != vertex) continue;
      if (cut.sets[a] >= 0)
        side = cut.element.side[a];
      else if (!side)
        side = cut.snapped;
    }
  if (side) return *side == xfem::Side::plus ? 1 : -1;
  return scene.d().cracks.side(0, scene.mesh().point(vertex));
}

/// What a row has in the sided field: nodes and particles that of their side, enriched sets half the jump.
inline Vector<2> value_at(Scene& scene, Index row, const SidedField& field)
{
  const Vector<2> x = scene.place(row);
  const bool set = row >= scene.rows().nodes && row < scene.rows().first_particle();
  if (set) return 0.5 * (field.plus(x) - field.minus(x));
  const int side = row < scene.rows().nodes ? node_side(scene, scene.d().nodes[static_cast<std::size_t>(row)])
                                            : scene.d().cracks.side(0, x);
  return side > 0 ? field.plus(x) : field.minus(x);
}

/// The sided field at all rows, [owned | halo].
inline std::vector<double> sided_blocks(Scene& scene, const SidedField& field)
{
  std::vector<double> owned, all;
  for (Index row = 0; row < scene.rows().owned(); ++row) {
    const Vector<2> value = value_at(scene, row, field);
    owned.insert(owned.end(), {value.x(), value.y()});
  }
  scene.system().halo->fetch(owned, 2, all);
  return all;
}

/// Prescribes the sided field wherever the conditions hold a component.
inline void prescribe_sided(Scene& scene, const SidedField& field)
{
  auto& [components, values] = scene.system().prescribed;
  for (std::size_t k = 0; k < components.size(); ++k)
    values[k] = value_at(scene, components[k] / 2, field)[components[k] % 2];
}

/// Largest distance of the solution from the sided field over the field's largest value.
inline double sided_error(Scene& scene, Vec u, const SidedField& field)
{
  const double* values = nullptr;
  double worst = 0.0, size = 0.0;
  PDX_CALL(VecGetArrayRead(u, &values));
  for (Index row = 0; row < scene.rows().owned(); ++row) {
    const Vector<2> exact = value_at(scene, row, field);
    worst = std::max(worst, (Vector<2>(values[2 * row], values[2 * row + 1]) - exact).norm());
    size = std::max(size, exact.norm());
  }
  PDX_CALL(VecRestoreArrayRead(u, &values));
  return scene.max(worst) / scene.max(size);
}

/// A straight crack through the whole unit square: a point of it and its angle to the x axis.
inline crack::Polyline through_crack(const Vector<2>& point, double angle)
{
  const Vector<2> along(std::cos(angle), std::sin(angle));
  return {point - 3.0 * along, point + 3.0 * along};
}

/// A small rigid motion, about the middle of the unit square.
inline Field rigid(double x, double y, double rotation)
{
  return affine(0.0, -rotation, rotation, 0.0, {x + 0.5 * rotation, y - 0.5 * rotation});
}
} // namespace pdx::test
