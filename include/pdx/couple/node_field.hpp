#pragma once
#include "pdx/couple/surroundings.hpp"
#include "pdx/field/rows.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <memory>

namespace pdx::couple {
/// Values at every mesh vertex from the rows: a vertex of elements has its own, one under a patch takes the bilinear
/// value of the four particles around it (as [XPD1] does for Eq. 28).
class NodeField {
public:
  /// Collective. @param node_rows global row of every local vertex, -1 under a patch; outlives this
  NodeField(const mesh::Mesh& mesh, std::span<const PetscInt> node_rows,
            std::span<const std::unique_ptr<pd::LatticePart<2>>> parts);
  /// Global rows read besides those of owned vertices; they must be in the halo given to `bind`.
  const std::vector<PetscInt>& needed_rows() const { return rows_; }
  void bind(const field::RowHalo& halo);
  /// Displacement of every local vertex, 2 each [m]. Collective. @param u local blocks [owned | halo]
  std::vector<double> displacement(std::span<const double> u) const;

private:
  const mesh::Mesh& mesh_;
  std::span<const PetscInt> node_rows_;
  PetscInt first_ = 0;                  // owned row
  std::vector<Index> covered_;          // owned vertices without a row, ascending
  std::vector<std::size_t> offsets_{0}; // of each, into those below
  std::vector<PetscInt> rows_;          // global, local after bind
  std::vector<double> weights_;
};
} // namespace pdx::couple
