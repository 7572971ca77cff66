#pragma once
#include "pdx/adapt/scene_view.hpp"
#include "pdx/adapt/space_view.hpp"
#include "pdx/fem/corner_areas.hpp"
#include "pdx/scene/handed.hpp"
#include "pdx/scene/layout.hpp"
#include "pdx/scene/patches.hpp"
#include "pdx/scene/point_plan.hpp"
#include "pdx/scene/standing.hpp"

namespace pdx::scene {
/// What a scene in the plane stands on: its mesh and the particles of its patches, not yet discretised.
struct Ground {
  options::SceneOptions options;
  mesh::MeshOptions mesh_options;
  PatchPlan plan;
  mesh::Mesh mesh;
  fem::CornerAreas areas;                     ///< of the mesh
  std::vector<pd::Particle> particles;        ///< none before `lay_particles`
  std::shared_ptr<const PointPlan<2>> points; ///< null without bodies of material points

  /// Throws UserError for what does not fit. Collective.
  /// @param costs by which the mesh is cut; null: by what cells hold
  Ground(MPI_Comm comm, options::SceneOptions given, const mesh::MeasuredCosts* costs = nullptr,
         std::shared_ptr<const PointPlan<2>> bodies = nullptr);
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;
  /// Covers cells and fills the patches, where there are any. Collective.
  /// @param kept knows patches that stay; null: all are new
  void lay_particles(Kept* kept = nullptr);
  /// Another layout on the same mesh: patches move, cells change hands. Collective.
  /// @param given with that layout   @param kept is told it
  void lay_again(options::SceneOptions given, Kept* kept = nullptr);
  std::vector<std::string> warnings() const; ///< of what is odd but allowed, "" for none
};

/// Stable steps of a scene, for the report [s].
struct StepLimits {
  double rigorous = 0.0;
  double papers = 0.0; ///< [XPD1 Eq. 26] of the finest patch; 0 without patches
};

/// A scene in time under one layout, with all that it stands on. A change of layout makes another.
class Scene {
public:
  virtual ~Scene() = default;
  virtual Standing standing() = 0;
  virtual field::System& system() = 0;
  virtual StepLimits limits() = 0; ///< Collective.
  /// What can be asked to move the patches; throws std::logic_error where there are none that move.
  virtual adapt::SceneView view() const { throw std::logic_error("a scene without patches that move"); }
  virtual const PatchPlan& patches() const
  {
    throw std::logic_error("a scene without patches that move");
  } ///< likewise
  /// The same of points and particles in space; null where there is no such scene.
  virtual const adapt::SpaceView* space() const { return nullptr; }
  /// Another layout is about to take the place of this one: from now on, and from the change until `settle`, energies
  /// are those of what it changes, so that their difference is what comes or goes. Both are collective.
  virtual void foresee(const Layout&) {}
  virtual void settle() {}
  /// Meanwhile, the rows that the change is about; nothing: all.
  virtual std::optional<std::vector<std::array<Index, 2>>> changing_rows() const { return std::nullopt; }
  /// Another layout on the same mesh takes the place of this one. Returns what of its rows goes on as it is; nothing
  /// where all goes by name. Collective.
  virtual std::optional<Handed> change(const Layout&) { throw std::logic_error("a scene without patches that move"); }
  virtual bool hands_over(const Layout&) const { return false; } ///< will `change` to that return something?
  virtual std::vector<std::string> warnings() { return {}; }
};

/// Makes a scene for a layout, its mesh cut by measured costs if there are any. Collective. Throws UserError for what
/// does not fit, Stopped when a signal came.
using SceneMaker = std::function<std::unique_ptr<Scene>(const Layout& layout, const mesh::MeasuredCosts* costs)>;

/// The scene in time that the options are about: bodies of material points alone, on grids that stay or are made anew,
/// or beside elements and particles in the plane; a cloud; a solid; elements and patches in the plane. Fills bodies and
/// reads clouds, and moves the options into the frame of what they are about. Collective. @param options outlive the
/// result
SceneMaker scene_in_time(MPI_Comm comm, options::SceneOptions& options);
} // namespace pdx::scene
