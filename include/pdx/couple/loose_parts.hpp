#pragma once
#include "pdx/couple/carried_bonds.hpp"
#include "pdx/couple/foreign_ends.hpp"
#include "pdx/field/system.hpp"
#include "pdx/pd/lattice_part.hpp"
#include "pdx/xfem/enriched_sets.hpp"

#include <memory>

namespace pdx::couple {
/// What holds rows together.
struct JoinedModels {
  const mesh::Mesh& mesh;
  std::span<const PetscInt> node_rows; ///< global row of each local vertex, -1 for none
  const xfem::EnrichedSets* sets;      ///< numbered; null without cracks
  std::span<const std::unique_ptr<pd::LatticePart<2>>> parts;
  const CarriedBonds<2>* carried; ///< null without an interface
};

/// A part of the body that its supports do not hold.
struct LoosePart {
  geom::Box<2> box;                      ///< of its rows [m]
  std::int64_t nodes = 0, particles = 0; ///< in it
  std::string motion;                    ///< "slide along x", "slide along y" and "rotate", as far as free
  std::int64_t others = 0;               ///< further parts that are loose
  bool whole = false;                    ///< the body is in one part
};

/// Finds what holds together: nodes by elements (either side of a crack for itself: there a far half counts as a node),
/// particles by intact bonds, both by carried bonds. The same answer on any number of ranks.
class LooseParts {
public:
  /// All must outlive this; the system is bound. Collective.
  LooseParts(const JoinedModels& models, const field::System& system);
  ~LooseParts();

  /// The largest part whose prescribed components leave a rigid motion free. What is joined to nothing is passed over,
  /// as are unloaded parts of at most `debris` particles. Collective.
  std::optional<LoosePart> find(Index debris) const;

private:
  class Ties;
  struct Part;
  void tie(Ties& ties, bool thoroughly) const;
  void tie_elements(Ties& ties) const;
  void tie_particles(Ties& ties, const pd::LatticePart<2>& part, std::size_t number, bool thoroughly) const;
  std::optional<LoosePart> judge(const std::vector<PetscInt>& labels, Index debris) const;

  JoinedModels models_;
  const field::System& system_;
  std::vector<ForeignEnds> foreign_;          // per patch
  mutable std::unique_ptr<Ties> by_elements_; // once somebody asked: they stay
};
} // namespace pdx::couple
