#pragma once
#include "pdx/base/petsc.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace pdx::io {
/// The rows of a table that a rank reads or writes.
struct Block {
  PetscInt first = 0, rows = 0;
};
/// This rank's share of a table. Collective.
Block block_of(MPI_Comm comm, PetscInt total);

/// Between things as ranks hold them and a table in their natural order, which does not depend on the number of ranks.
/// Each rank reads and writes a block of rows of the table.
class NaturalOrder {
public:
  /// @param total rows of the table   @param held natural number of each thing here. Collective.
  NaturalOrder(MPI_Comm comm, PetscInt total, std::span<const PetscInt> held);

  const Block& block() const { return block_; }
  /// This rank's block of the table; each thing must be held once, rows that nobody holds are 0. Collective.
  /// @param values things held x components
  std::vector<double> to_table(std::span<const double> values, int components) const;
  std::vector<std::uint64_t> to_table(std::span<const std::uint64_t> values, int components) const;

private:
  template <class T> std::vector<T> gather(std::span<const T> values, int components) const;

  SfHandle sf_;
  Block block_;
};
} // namespace pdx::io
