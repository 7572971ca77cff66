#pragma once
#include "pdx/couple/carried_bonds.hpp"
#include "pdx/fem/elastic_term.hpp"
#include "pdx/field/system.hpp"
#include "pdx/pd/bond_term.hpp"
#include "pdx/scene/handed.hpp"
#include "pdx/scene/patches.hpp"
#include "pdx/scene/touched_cells.hpp"

namespace pdx::scene {
struct Discretisation;

/// Owned rows of the nodes of some cells, and of all enriched sets; ascending.
std::vector<Index> near_rows(const Discretisation& scene, const mesh::Mesh& mesh, std::span<const Index> cells);

/// What of a scene in the plane goes on in the next one on the same mesh: patches that stay as they are, with what was
/// found around them. Where a change is far away that is nearly all, and nothing of it is made or copied again.
class Kept {
public:
  /// All that might stay leaves the scene, which is about to go. Nothing where it does not step explicitly with the
  /// energy scheme, where it has bodies of points, or where its mesh is parted: these are made anew.
  static std::optional<Kept> of(Discretisation& scene, const mesh::Mesh& mesh, const options::SceneOptions& options);
  /// Will `of` find anything?
  static bool may_stay(const Discretisation& scene, const options::SceneOptions& options);

  /// Which patches of a scene stay under the next layout, for each of its own.
  static std::vector<bool> staying(const Discretisation& scene, std::span<const couple::PatchShape> next);
  /// Cells that these leave, or that patches to come take. Local ones, ascending.
  static std::vector<Index> touched(const Discretisation& scene, const mesh::Mesh& mesh,
                                    std::span<const couple::PatchShape> next);
  /// The next layout is known: which of its patches are those before?
  void match(const PatchPlan& next);
  /// For each patch of the next layout: is it one before? Whether it stays is known after `number`.
  const std::vector<bool>& same() const { return same_; }
  bool has(std::size_t patch) const { return patch < from_.size() && from_[patch] >= 0; }        ///< of the next layout
  std::size_t before(std::size_t patch) const { return static_cast<std::size_t>(from_[patch]); } ///< its number then
  /// Cells that patches leave are uncovered; those that patches to come take are noted by who covers them.
  ///@{
  void uncover(mesh::Mesh& mesh);
  void note(Index cell, mesh::Use before) { touched_.note(cell, before); }
  ///@}
  /// The enriched sets, if all that changed is away from them: else null, and no cell is cut. Collective.
  std::unique_ptr<xfem::EnrichedSets> sets(mesh::Mesh& mesh, const crack::CrackSet& cracks);
  bool keeps_sets() const { return keeps_sets_; } ///< after `sets`; true without cracks
  /// Owned vertices with a row, and those of before in `rows`, to be numbered anew. Cells have their uses.
  std::vector<Index> nodes(const mesh::Mesh& mesh, std::vector<PetscInt>& rows);
  /// Its rows are numbered: nothing stays if enriched sets are others. Collective.
  /// @param band sites around patches that are looked at
  void number(const Discretisation& next, const mesh::Mesh& mesh, Index band);
  /// After `number`.
  ///@{
  const field::StayingRows& rows() const { return handed_.rows; }
  Handed handed() { return std::move(handed_); }
  /// Of rows that stay; of others 0.
  std::vector<double> coordinates();
  /// The same of mass and what goes with it; all but `near` are right.
  void give_mass(field::System& next);
  /// Rows of the next layout of which mass, stiffness or forces may be others than before.
  std::vector<std::array<Index, 2>> near(const Discretisation& next, const mesh::Mesh& mesh) const;
  /// Null where there were none; told what changed.
  std::unique_ptr<fem::ElasticTerm> elements(const mesh::Mesh& mesh, std::span<const PetscInt> node_rows);
  std::vector<Index> touched() const { return touched_.all(); }
  ///@}

  /// Owned particles of the next layout. @param fresh those of patches that are new, by patch and site
  std::vector<pd::Particle> particles(std::span<const pd::Particle> fresh, std::size_t patches);
  /// For each patch of the next layout, null or none for what is new. Each once, after `number`.
  ///@{
  std::unique_ptr<pd::LatticePart<2>> part(std::size_t patch, pd::BondTerm<2>::Laid& laid);
  std::vector<std::optional<couple::Surroundings>> around();
  couple::KeptFamilies families();
  ///@}

private:
  std::vector<couple::PatchShape> shapes_; // of the layout before, as is what follows
  std::vector<couple::Surroundings> around_;
  pd::BondTerm<2>::Parts parts_;
  couple::CarriedBonds<2>::Families families_;
  std::vector<pd::Particle> particles_;
  std::vector<Index> nodes_, sets_; // vertices
  std::vector<field::RowName> set_names_;
  std::vector<PetscInt> node_rows_;
  std::vector<double> coordinates_, mass_, inverse_mass_;
  std::unique_ptr<fem::ElasticTerm> elements_;
  std::unique_ptr<xfem::EnrichedSets> sets_object_;
  TouchedCells touched_;
  bool keeps_sets_ = true;
  Handed handed_;
  std::unique_ptr<field::RowHalo> halo_;
  std::vector<int> from_; // per patch of the next layout: its number before, -1: it is new
  std::vector<bool> same_;
  std::shared_ptr<const field::RowShift> shift_;
};
} // namespace pdx::scene
