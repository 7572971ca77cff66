#pragma once
#include "pdx/adapt/scene_view.hpp"
#include "pdx/fem/element.hpp"
#include "pdx/law/regions.hpp"

#include <unordered_map>

namespace pdx::adapt {
/// Strain energy density per owned row, bonds that leave their patch included; 0 where no particle is [J/m^3].
std::vector<double> energy_density(const SceneView& scene, std::span<const double> local);

/// Whether a cell's particles may become an element: where the strain energy of the element would be much more than
/// theirs, what they hold is finer than it can carry.
class EnergyTrial {
public:
  /// What is asked for beside the view. Lent for the trial.
  struct Given {
    std::span<const double> displacement; ///< local blocks [owned | halo] [m]
    std::span<const double> density;      ///< strain energy, per owned row [J/m^3]
    const law::Elastic& elastic;
    law::Kinematics kinematics;
    double most;                           ///< that one element may add [J]
    const law::Regions* regions = nullptr; ///< of other materials
  };
  EnergyTrial(const SceneView& scene, const Given& given);

  /// @param cell owned   @param paths of cracks: each side is a piece of its own
  bool allows(Index cell, const crack::CrackSet& paths) const;

private:
  using Piece = std::vector<std::size_t>; // particles
  std::vector<Piece> pieces(Index cell, const crack::CrackSet& paths) const;
  double energy_of_element(const Piece& piece) const;
  double volume(std::size_t particle) const;
  const law::Elastic& law_of(std::size_t particle) const;
  std::size_t row(std::size_t particle) const;

  const SceneView& scene_;
  Given given_;
  std::unordered_map<Index, Piece> in_cell_;
};
} // namespace pdx::adapt
