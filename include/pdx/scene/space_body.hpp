#pragma once
#include "pdx/adapt/space_view.hpp"
#include "pdx/scene/space_plan.hpp"

namespace pdx::scene {
/// Bodies of material points in space, and particles in cells of theirs.
struct SpaceModel final : Model {
  const SpaceBodies* space = nullptr; ///< outlives this, as the mesh
  const mesh::Mesh* mesh = nullptr;
  SpacePlan plan;
  TakenCells<3> taken;
  PointBody<3>* points = nullptr;             ///< borrowed from parts
  pd::BondTerm<3>* bonds = nullptr;           ///< borrowed from system.terms
  couple::CarriedBonds<3>* carried = nullptr; ///< likewise
  std::span<const mpm::GridCell<3>> own_cells() const
  {
    return std::span<const mpm::GridCell<3>>(points->grid.cells).first(points->grid.owned);
  }

  explicit SpaceModel(SpacePlan of) : plan(std::move(of)) {}
  adapt::SpaceView view() const;
};

/// Rows, Terms and conditions of the bodies under one layout, `options.pd.cells`, ready to be stepped explicitly.
/// Collective. Throws UserError for conditions that are nowhere.
std::unique_ptr<SpaceModel> discretise(const options::SceneOptions& options, const SpaceBodies& bodies,
                                       const mesh::Mesh& mesh);
} // namespace pdx::scene
