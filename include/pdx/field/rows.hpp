#pragma once
#include "pdx/base/petsc.hpp"

#include <array>
#include <span>
#include <vector>

namespace pdx::field {
/// Every unknown is a block of `dim` displacements carried by a row. Rows of a rank are contiguous:
/// [FE nodes | enriched sets | particles].
struct Rows {
  MPI_Comm comm = MPI_COMM_NULL;
  int dim = 2;
  Index nodes = 0, enriched = 0, particles = 0; ///< owned rows by kind
  PetscInt first = 0, total = 0;                ///< first owned row, rows of all ranks

  /// Counts the rows before ours. Collective.
  static Rows number(MPI_Comm comm, int dim, Index nodes, Index enriched, Index particles);
  Index owned() const { return nodes + enriched + particles; }
  Index first_particle() const { return nodes + enriched; } ///< local row of the first particle
  bool owns(PetscInt row) const { return row >= first && row < first + owned(); }
  VecHandle vector() const; ///< zero vector with this layout and block size dim. Collective.
};

/// Local rows, by first and end of each range, ascending and apart.
using RowRanges = std::span<const std::array<Index, 2>>;

/// The values of this rank's rows, and the other way round.
std::vector<double> owned_values(Vec u);
void set_owned_values(Vec u, std::span<const double> values);

/// Local view of rows: [owned | halo]. The halo is what some Term reads of other ranks.
class RowHalo {
public:
  /// @param needed global rows read here; owned ones and repeats are allowed. Collective.
  RowHalo(const Rows& rows, std::vector<PetscInt> needed);

  const Rows& rows() const { return rows_; }
  Index size() const { return rows_.owned() + static_cast<Index>(halo_.size()); }
  Index local(PetscInt row) const; ///< local number of a global row; it must be owned or in the halo
  PetscInt global(Index local) const;
  /// Copies the owned blocks of u and fetches the halo: size() * dim values. Collective.
  void gather(Vec u, std::vector<double>& blocks) const;
  /// Fetches the halo behind the owned values that stand in `blocks` (size() * dim) already. Collective.
  void refresh(std::span<double> blocks) const;
  /// The same for flat per-row data of any number of components per row. Collective.
  void fetch(std::span<const double> owned, int components, std::vector<double>& all) const;
  /// Adds the halo part of `all` (size() * components) to the owners' values, which stand first. Collective.
  void reduce(std::vector<double>& all, int components) const;

private:
  void broadcast(double* all, int components) const;

  Rows rows_;
  std::vector<PetscInt> halo_; ///< global rows, ascending
  SfHandle sf_;
};
} // namespace pdx::field
