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

/// Particles that lie anywhere, in the plane or in space: rows, bonds and conditions, ready to be stepped explicitly.
struct CloudModel : Model {
  std::string description; ///< that a checkpoint of the same cloud shares
  std::vector<Index> sets; ///< of the owned particles

  virtual std::vector<double> positions() const = 0; ///< of the owned particles, three each [m]
  virtual std::vector<double> volumes() const = 0;   ///< likewise [m^3]
  virtual std::vector<pd::BondedVolume> bonded_volume() const = 0;
  virtual int words_per_particle() const = 0; ///< the two below as CloudTerm's
  virtual std::vector<std::uint64_t> gone() const = 0;
  virtual void set_gone(std::span<const std::uint64_t> words) = 0;
  Tiles tiles() const override { return {}; }
};

template <int Dim> struct CloudBody final : CloudModel {
  pd::CloudTerm<Dim>* bonds = nullptr; ///< borrowed from system.terms

  post::Energies energies(std::span<const double> local) const override;
  std::vector<double> positions() const override;
  std::vector<double> volumes() const override { return {bonds->volumes().begin(), bonds->volumes().end()}; }
  std::vector<pd::BondedVolume> bonded_volume() const override { return bonds->bonded_volume(); }
  int words_per_particle() const override { return bonds->words_per_particle(); }
  std::vector<std::uint64_t> gone() const override { return bonds->gone(); }
  void set_gone(std::span<const std::uint64_t> words) override { bonds->set_gone(words); }
};

/// Collective. Throws UserError for conditions and cracks that are nowhere in the cloud, and for one without bonds.
template <int Dim>
std::unique_ptr<CloudBody<Dim>> discretise(MPI_Comm comm, const options::SceneOptions& options,
                                           const CloudPlan<Dim>& plan, std::vector<pd::Particle> particles);

/// Turns the boundary conditions into prescribed components and loads of `body.system`; they act on the particles of a
/// box, which reaches through the body, of a set, or of both. Collective. Throws UserError for a place that selects
/// nothing.
template <int Dim>
void apply_conditions(const options::SceneOptions& options, const pd::Cloud<Dim>& cloud, CloudBody<Dim>& body);
} // namespace pdx::scene
