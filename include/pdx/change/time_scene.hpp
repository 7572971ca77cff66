#pragma once
#include "pdx/adapt/hand_back.hpp"
#include "pdx/adapt/layout_change.hpp"
#include "pdx/scene/named_state.hpp"
#include "pdx/scene/scene.hpp"
#include "pdx/solve/time_driver.hpp"

#include <array>

namespace pdx::change {
/// A scene in time and what steps it, under one layout after the other: each takes over by name what the one before has
/// come to. All methods are collective.
class TimeScene {
public:
  /// Nothing stands yet. @param options, make outlive this
  TimeScene(MPI_Comm comm, const options::SceneOptions& options, const scene::SceneMaker& make)
      : comm_(comm), options_(options), make_(make), layout_(scene::Layout::given(options))
  {}
  /// Before anything is built: as a checkpoint says, from which the run goes on.
  void begin_with(scene::Layout layout, scene::Dormant dormant);

  /// The scene, on a mesh of its own, and its driver.
  void build();

  scene::Standing standing() const { return scene_->standing(); }
  adapt::SceneView view() const { return scene_->view(); }
  const adapt::SpaceView* space() const { return scene_->space(); }
  const scene::PatchPlan& patches() const { return scene_->patches(); }
  std::vector<std::string> warnings() const { return scene_->warnings(); }
  solve::TimeDriver& driver() { return *driver_; }
  const solve::TimeDriver& driver() const { return *driver_; }
  const scene::StepLimits& limits() const { return limits_; }
  const scene::Layout& layout() const { return layout_; }
  const scene::Dormant& dormant() const { return dormant_; }

  /// A change of layout is about to come, until `settle`: as scene::Scene has it.
  void foresee(const adapt::LayoutChange& change)
  {
    if (!change.empty()) scene_->foresee(layout_.changed(change));
    driver_->count_only(scene_->changing_rows());
  }
  void settle()
  {
    scene_->settle();
    driver_->count_only(std::nullopt);
  }

  /// All that a scene has come to, and what the rows that a change makes begin with.
  struct Moment {
    scene::NamedState state; ///< of a scene that is handed over: of what does not stay, after `rebuild`
    scene::Passing passing;  ///< of what stays
    pd::Broken broken;
    solve::TimeDriver::Clock clock;
    std::vector<double> sums;              ///< `Model::rank_sums`
    std::array<double, 3> momentum{};      ///< where patches move [kg m/s]
    Vector<3> angular = Vector<3>::Zero(); ///< likewise [kg m^2/s]
    std::size_t known = 0;                 ///< rows that were there before
    adapt::Leaving left;
    adapt::FreshRows fresh;
    std::optional<scene::Handed> handed;
  };
  /// @param change to come; empty: all is built anew as it is   @param cracks as they have been followed
  Moment moment(const adapt::LayoutChange& change, std::optional<scene::CrackNotes> cracks) const;
  /// Scene and driver go, and others stand in their place. @param costs by which meshes are cut from now on, if any
  void rebuild(const adapt::LayoutChange& change, std::optional<mesh::MeasuredCosts> costs, Moment& moment);
  /// They take over a moment of those before. Returns the cracks. @param change that made them
  std::optional<scene::CrackNotes> take(Moment moment, const adapt::LayoutChange& change);

private:
  void drive(solve::MovingSystem::Values known = {});
  void begin_changed(const Moment& moment, const scene::StateMove& move, const adapt::LayoutChange& change);

  MPI_Comm comm_;
  const options::SceneOptions& options_;
  const scene::SceneMaker& make_;
  scene::Layout layout_;
  scene::Dormant dormant_;
  std::optional<mesh::MeasuredCosts> costs_; // none: a mesh is cut by what cells hold
  bool begun_ = false;                       // a driver was there, or a checkpoint
  std::unique_ptr<scene::Scene> scene_;
  scene::StepLimits limits_;
  std::unique_ptr<solve::TimeDriver> driver_; // on scene_
};
} // namespace pdx::change
