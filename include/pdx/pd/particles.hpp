#pragma once
#include "pdx/base/petsc.hpp"

#include <span>
#include <vector>

namespace pdx::pd {
/// One particle as it travels: which lattice site it is, and where.
struct Particle {
  Index patch; ///< number of its patch
  Index site;  ///< number of its site in the patch's lattice
  Index cell;  ///< local cell that holds it; -1 after a migration, until it is located again
  Vector<2> x; ///< reference position [m]
};

/// The particles of a solid or a cloud as a DMSwarm that follows the cells: each lives on the rank of the cell that
/// holds it. Kernels do not look in here; they take flat arrays (LatticePart) at every change of layout.
class Particles {
public:
  /// An empty swarm. Collective.
  explicit Particles(MPI_Comm comm);
  /// Appends particles on this rank.
  void add(std::span<const Particle> particles);
  /// Sends particle k of this rank to rank owner[k]. Collective.
  void migrate(std::span<const int> owner);
  /// This rank's particles, by patch and site.
  std::vector<Particle> sorted() const;
  Index local_size() const;
  DM swarm() const { return swarm_.get(); }

private:
  DmHandle swarm_;
};
} // namespace pdx::pd
