#pragma once
#include "pdx/couple/foreign_ends.hpp"
#include "pdx/field/rows.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <memory>
#include <optional>

namespace pdx::couple {
/// A particle in a cell of a patch's grid, owned here or not.
struct CellParticle {
  int patch = 0;
  Index cell = 0; ///< number in the list of cells that are looked at
  Index site = 0; ///< number in the patch's lattice
  Vector<2> x;    ///< [m]
};

/// What a particle leans on at a node: a part of the particles around the node that intact bonds hold together.
struct PartOfNode {
  static constexpr int kNone = -1; ///< a part too small to have an unknown of its own
  std::size_t particle;            ///< number in `SupportParts::particles`
  int part;                        ///< 0, 1, ... or kNone
};

/// Splits the particles in the cells around a node where bonds are broken: a crack needs no geometry to be seen, its
/// bond words are enough. Each part that holds together is one coarse unknown.
class SupportParts {
public:
  /// @param particles cell after cell   @param cells their number. Collective.
  SupportParts(const field::Rows& rows, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
               std::vector<CellParticle> particles, Index cells);

  std::span<const CellParticle> particles() const { return particles_; }
  /// Particles of a cell, as numbers [first, second).
  std::pair<std::size_t, std::size_t> in_cell(Index cell) const;
  /// Fetches the bond words of all particles. Collective.
  void update();
  /// Intact share of the bonds that a particle would have in the whole lattice, alike on every rank [-].
  double health(std::size_t particle) const { return health_[particle]; }
  bool damaged(Index cell) const { return damaged_[static_cast<std::size_t>(cell)] != 0; }
  /// The parts of the particles in the given cells, by particle; weight(particle) is what a part is measured by: parts
  /// below a twentieth of the whole get no number, the others are numbered by their first particle.
  std::vector<PartOfNode> split(std::span<const Index> cells,
                                const std::function<double(const CellParticle&)>& weight) const;

private:
  struct Patch {
    std::optional<ForeignEnds> foreign; ///< which are told what our particles lost
    Site<2> lower{}, extent{};
    std::vector<Index> number; ///< per site of the box: particle + 1, 0 = none
  };
  Index find(int patch, const Site<2>& site) const;
  std::vector<double> lost_bonds() const;

  std::span<const std::unique_ptr<pd::LatticePart<2>>> parts_;
  std::vector<CellParticle> particles_; // cell after cell
  std::vector<std::size_t> offsets_;    // per cell
  std::vector<Patch> patches_;
  std::unique_ptr<field::RowHalo> halo_;
  std::vector<Index> rows_; // of particles_, in halo_
  std::vector<std::array<std::uint64_t, 2>> words_;
  std::vector<double> health_;
  std::vector<std::uint8_t> damaged_; // per cell
  mutable std::vector<Index> place_;  // of a particle in the split at work, else -1
};
} // namespace pdx::couple
