#pragma once
#include "pdx/base/petsc.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace pdx::io {
/// Between things as ranks hold them and a table in their natural order, which does not depend on the number of ranks.
/// Each rank reads and writes a block of rows of the table.
class NaturalOrder {
public:
  /// @param total rows of the table   @param held natural number of each thing here. Collective.
  NaturalOrder(MPI_Comm comm, PetscInt total, std::span<const PetscInt> held);

  PetscInt first() const { return first_; } ///< of this rank's block
  PetscInt rows() const { return rows_; }   ///< in it
  /// This rank's block of the table; each thing must be held once, rows that nobody holds are 0. Collective.
  /// @param values things held x components
  std::vector<double> to_table(std::span<const double> values, int components) const;
  std::vector<std::uint64_t> to_table(std::span<const std::uint64_t> values, int components) const;
  /// The things held here, from the blocks of the table. Collective.
  std::vector<double> from_table(std::span<const double> block, int components) const;
  std::vector<std::uint64_t> from_table(std::span<const std::uint64_t> block, int components) const;

private:
  template <class T> std::vector<T> gather(std::span<const T> values, int components) const;
  template <class T> std::vector<T> spread(std::span<const T> block, int components) const;

  SfHandle sf_;
  PetscInt first_ = 0, rows_ = 0;
  std::size_t held_ = 0;
};
} // namespace pdx::io
