#pragma once
#include "pdx/app/crack_watch.hpp"
#include "pdx/io/natural_order.hpp"
#include "pdx/io/sealed_reader.hpp"
#include "pdx/solve/time_driver.hpp"

namespace pdx::app {
/// What moves and breaks in a scene, as tables in a natural order that does not depend on the number of ranks: nodes by
/// mesh vertex, then enriched sets by vertex and crack, then particles by patch and site.
class SceneState {
public:
  /// What `scene` points to must outlive it. Collective.
  SceneState(const Standing& scene, const SceneOptions& options);

  /// What makes a scene this one, "name = value" a line: a state fits only where all of them are the same.
  const std::string& scene() const { return text_; }
  /// Adds the tables to a file. Collective.
  void write(io::Hdf5File& file, const solve::TimeDriver& driver) const;
  /// Breaks the bonds that are broken there and gives the state to the driver. Collective.
  void read(const io::SealedReader& file, const solve::TimeDriver::Clock& clock, solve::TimeDriver& driver) const;
  /// What was seen of the cracks, likewise. Collective.
  void write_cracks(io::Hdf5File& file, const CrackNotes& notes) const;
  std::optional<CrackNotes> read_cracks(const io::SealedReader& file) const; ///< none if there is nothing

private:
  void number_rows();
  void note_supports(std::span<const PetscInt> numbers);
  bool is_watched(std::size_t k) const;
  void describe(const SceneOptions& options);
  PetscInt particle_number(Index patch, Index site) const;
  std::vector<double> read_rows(const io::SealedReader& file, const std::string& name) const;
  void read_bonds(const io::SealedReader& file) const;
  std::string fault_of_arrival(std::span<const double> row, const post::CrackTracker::State& before) const;

  template <class Visit> void with_bonds(Visit&& visit) const;
  int words_per_particle() const; ///< of their bonds

  Standing scene_;
  const Model& model_;
  std::vector<PetscInt> first_; // number of each patch's first particle, and of the one behind the last
  PetscInt sets_ = 0;           // on all ranks
  std::unique_ptr<io::NaturalOrder> rows_, particles_;
  std::string supports_, text_;
};
} // namespace pdx::app
