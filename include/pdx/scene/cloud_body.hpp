#pragma once
#include "pdx/pd/cloud_term.hpp"
#include "pdx/scene/model.hpp"

namespace pdx::scene {

/// A cloud as the file has it, and the background cells that part it among the ranks.
template <int Dim> struct CloudPlan {
  pd::Cloud<Dim> particles;
  mesh::MeshOptions mesh;  ///< a box around all particles, half a particle wider
  std::vector<int> counts; ///< particles per cell, x fastest
  std::string fingerprint; ///< tells this cloud from others

  Index cell_at(const Vector<2>& x) const; ///< in the plane; outside the box the nearest [m]
};

/// Reads the file, alike on every rank, and moves cloud and options into its frame. Throws UserError.
template <int Dim> CloudPlan<Dim> plan_cloud(options::SceneOptions& options);

/// Cost of a cell: its particles.
template <int Dim> mesh::CellCost cell_cost(const CloudPlan<Dim>& plan);

/// The particles over the cells this rank owns; `Particle::site` is the place in the file. Collective.
template <int Dim>
std::vector<pd::Particle> make_particles(const mesh::Mesh& mesh, const CloudPlan<Dim>& plan, pd::Particles& swarm);

/// Particles that lie anywhere, in the plane or in space, and their bonds.
template <int Dim> class CloudPart final : public Part {
public:
  /// @param model outlives this, as its Term does
  CloudPart(const Model& model, pd::CloudTerm<Dim>& bonds, std::string description, std::vector<Index> sets)
      : model_(model), bonds_(bonds), description_(std::move(description)), sets_(std::move(sets))
  {}
  const Model& model() const { return model_; }
  const pd::CloudTerm<Dim>& bonds() const { return bonds_; }

  void add_names(std::vector<field::RowName>& names) const override;
  void add_numbers(std::vector<PetscInt>& first) const override;
  void add_energies(std::span<const double> local, post::Energies& mine) const override;
  void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const override;
  std::string described() const override { return "cloud = " + description_ + "\n"; }
  std::string counted(const options::SceneOptions& options) const override;
  bool works_in(const field::Term& term) const override { return &term == &bonds_; }
  void add_shares(std::vector<double>& cells) const override;
  int words_per_particle() const override { return bonds_.words_per_particle(); }
  std::vector<std::uint64_t> gone() const override { return bonds_.gone(); }
  void break_bonds(const BrokenBonds& broken) override { bonds_.set_gone(broken.mine); }

private:
  const Model& model_;
  pd::CloudTerm<Dim>& bonds_;
  std::string description_; // that a checkpoint of the same cloud shares
  std::vector<Index> sets_; // of the owned particles
};

/// Rows, bonds and conditions of a cloud, ready to be stepped explicitly; its one part is a CloudPart. Collective.
/// Throws UserError for conditions and cracks that are nowhere in the cloud, and for one without bonds.
template <int Dim>
std::unique_ptr<Model> discretise(MPI_Comm comm, const options::SceneOptions& options, const CloudPlan<Dim>& plan,
                                  std::vector<pd::Particle> particles);

/// Turns the boundary conditions into prescribed components and loads of a cloud; they act on the particles of a
/// box, which reaches through the body, of a set, or of both. Collective. Throws UserError for a place that selects
/// nothing.
template <int Dim>
void apply_conditions(const options::SceneOptions& options, const pd::Cloud<Dim>& cloud,
                      const pd::CloudTerm<Dim>& bonds, Model& model);
} // namespace pdx::scene
