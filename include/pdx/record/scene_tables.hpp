#pragma once
#include "pdx/io/natural_order.hpp"
#include "pdx/io/sealed_reader.hpp"
#include "pdx/scene/named_state.hpp"

namespace pdx::record {
/// A NamedState as tables of a file, in a natural order that does not depend on the number of ranks: nodes by mesh
/// vertex, then enriched sets by vertex and crack, then particles by patch and site, their names beside. Whoever reads
/// them need know nothing of that order.
class SceneTables {
public:
  /// What `scene` points to must outlive it. Collective.
  explicit SceneTables(const scene::Standing& scene);

  /// What makes a scene this one as it stands, "name = value" a line: a state fits only where all of them are the same.
  const std::string& scene() const { return text_; }
  /// @param state as `capture` makes it of this scene. Collective.
  void write(io::Hdf5File& file, const scene::NamedState& state) const;

private:
  void number_rows();
  void note_supports(std::span<const PetscInt> numbers);
  void describe();

  scene::Standing scene_;
  const scene::Model& model_;
  PetscInt sets_ = 0, particles_ = 0; // on all ranks
  std::unique_ptr<io::NaturalOrder> row_order_, particle_order_;
  std::string supports_, text_;
};

/// An even share of the tables of a file for each rank. Throws UserError for tables that do not belong together.
/// Collective.
scene::NamedState read_tables(MPI_Comm comm, const io::SealedReader& file, int dim);
} // namespace pdx::record
