#pragma once
#include "pdx/field/row_name.hpp"
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/sealed_reader.hpp"

#include <vector>

namespace pdx::scene {
struct NamedState;

constexpr int kLatticeWords = 2; ///< for the bonds of a particle on a lattice

/// What broke where there are elements now, for particles that may lie there again.
struct Dormant {
  std::vector<field::RowName> particles; ///< any share of those of all ranks, each on one of them
  std::vector<std::uint64_t> gone;       ///< as in NamedState, kLatticeWords for each
  std::vector<std::uint64_t> carried;    ///< keys that were ever broken, of all ranks, ascending

  /// Its tables in a checkpoint, in order of names on any number of ranks. Collective.
  void write(io::Hdf5File& file) const;
  /// An even share for each rank. Throws UserError for tables that do not belong together. Collective.
  static Dormant read(MPI_Comm comm, const io::SealedReader& file);
};

/// Adds it to what a scene owns, and to the rows that the next layout will have: particles that come where some are
/// dormant have what broke there, whatever rank knew of them. Collective.
void add_dormant(MPI_Comm comm, NamedState& state, const Dormant& dormant);
} // namespace pdx::scene
