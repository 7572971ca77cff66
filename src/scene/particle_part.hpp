#pragma once
#include "pdx/scene/discretisation.hpp"
#include "pdx/scene/dormant.hpp"

namespace pdx::scene {
/// Particles on lattices, in the plane or in space.
template <int Dim> class ParticlePart : public Part {
public:
  /// @param carried null without an interface   All outlive it.
  ParticlePart(const Model& model, pd::BondTerm<Dim>& bonds, couple::CarriedBonds<Dim>* carried)
      : model_(model), bonds_(bonds), carried_(carried)
  {}

  void add_energies(std::span<const double> local, post::Energies& mine) const override;
  void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const override;
  std::string counted(const options::SceneOptions& options) const override;
  std::optional<Tiles> tiles() const override { return Tiles{bonds_.tiles_computed(), bonds_.tiles_skipped()}; }
  bool works_in(const field::Term& term) const override { return &term == &bonds_ || &term == carried_; }
  void add_shares(std::vector<double>& cells) const override;
  int words_per_particle() const override { return kLatticeWords; }
  std::vector<std::uint64_t> gone() const override;
  void break_bonds(const BrokenBonds& broken) override;

protected:
  virtual field::RowName name(std::size_t patch, Index site) const = 0;
  couple::ParticleDamage damage() const;

  const Model& model_;
  pd::BondTerm<Dim>& bonds_;
  couple::CarriedBonds<Dim>* carried_;

private:
  field::OutputBlock block(const Picture& now) const;
  double kind_of(std::size_t k) const;
};

/// The patches of a scene in the plane, which outlives it.
std::unique_ptr<Part> patch_part(const mesh::Mesh& mesh, const Discretisation& d);

/// Adds damage and precrack, together if so asked.
void push_damage(const options::SceneOptions& options, couple::ParticleDamage damage, field::OutputBlock& block);

/// What to say of bonds that cannot break, "" for those that can.
const char* unbroken(const options::SceneOptions& options);

/// Adds a share for each particle to its cell.
void add_particle_shares(std::span<const pd::Particle> particles, std::vector<double>& cells);

/// A lattice in a checkpoint's description of its scene.
template <int Dim> std::string line_of(const geom::Lattice<Dim>& lattice, std::size_t bonds);
} // namespace pdx::scene
