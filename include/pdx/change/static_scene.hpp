#pragma once
#include "pdx/adapt/hand_back.hpp"
#include "pdx/adapt/layout_change.hpp"
#include "pdx/scene/discretisation.hpp"
#include "pdx/scene/named_state.hpp"
#include "pdx/scene/scene.hpp"

namespace pdx::change {
/// A static scene and its displacement, under one layout after the other: each is built on the ground of its own, and
/// takes over by name what the one before has come to. All methods are collective.
class StaticScene {
public:
  /// Nothing stands yet. @param options outlive this   @param assembled the tangent is a matrix
  /// @param points bodies of material points, settled; null without them
  StaticScene(MPI_Comm comm, const options::SceneOptions& options, bool assembled,
              std::shared_ptr<const scene::PointPlan<2>> points)
      : comm_(comm), options_(options), points_(std::move(points)), assembled_(assembled),
        layout_(scene::Layout::given(options))
  {}
  /// Before anything is laid: as a checkpoint says.
  void begin_with(scene::Layout layout, scene::Dormant dormant);

  /// The mesh and where patches will lie.
  void lay();
  /// Rows and Terms on the ground, whose particles are laid, with a displacement of 0.
  void build();
  bool assembled() const { return assembled_; }

  scene::Ground& ground() { return *ground_; }
  const scene::PatchPlan& plan() const { return ground_->plan; }
  scene::Discretisation& d() { return *d_; }
  const scene::Discretisation& d() const { return *d_; }
  scene::Standing standing() { return {&ground_->mesh, d_.get()}; }
  adapt::SceneView view() const { return d_->view(ground_->mesh); }
  Vec u() const { return u_.get(); }
  const scene::Layout& layout() const { return layout_; }
  const scene::Dormant& dormant() const { return dormant_; }

  /// Of owned components of a displacement: strain energy of all ranks [J], force of all Terms on owned components [N].
  ///@{
  double strain_energy(std::span<const double> u) const;
  std::vector<double> internal_force(std::span<const double> u) const;
  ///@}

  /// What the scene has come to at a displacement, and what the rows that a change makes begin with.
  struct Moment {
    scene::NamedState state;
    pd::Broken broken;
    std::size_t known = 0; ///< rows that were there before
    adapt::Leaving left;
  };
  /// @param change to come; empty: all is built anew as it is
  Moment moment(std::span<const double> u, const adapt::LayoutChange& change);
  /// The scene goes, and another stands in its place.
  void rebuild(const adapt::LayoutChange& change);
  /// That takes over what is broken, and returns its displacement at a moment of the one before.
  std::vector<double> take(const Moment& moment, const adapt::LayoutChange& change);
  /// What of the moment taken over last has no place stays dormant.
  void keep_dormant() { dormant_ = std::move(left_over_); }

private:
  MPI_Comm comm_;
  const options::SceneOptions& options_;
  std::shared_ptr<const scene::PointPlan<2>> points_;
  bool assembled_;
  scene::Layout layout_;
  scene::Dormant dormant_, left_over_;
  std::unique_ptr<scene::Ground> ground_;
  std::unique_ptr<scene::Discretisation> d_; // on ground_
  VecHandle u_;
};
} // namespace pdx::change
