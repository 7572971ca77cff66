#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/law/elastic.hpp"
#include "pdx/mpm/grid_rule.hpp"
#include "pdx/mpm/point_cells.hpp"

#include <optional>
#include <string>
#include <vector>

namespace pdx::options {
/// total: the grid is that of the reference state and kept. updated: it is fixed in space and made anew each step.
enum class Formulation { total, updated };

/// How particles act on points around them: bonds up to the border, with an energy of its own, or the paper's
/// handshake [APDMPM Eqs. 23-25, 29, 36-38].
enum class Coupling { energy, handshake };

/// What material points fill: one of these, in space with a depth along z where it is plane.
struct PointShape {
  struct Ball {
    Vector<3> centre = Vector<3>::Zero(); ///< [m]
    double radius = 0.0;                  ///< [m]
  };
  std::optional<geom::Box<3>> box;  ///< [m]
  std::optional<Ball> disc, sphere; ///< a disc in space is a cylinder along z
  std::vector<Ball> holes;          ///< round, through the body: whole cells with their middle in one are left out
  std::vector<std::array<Vector<2>, 2>> border; ///< edges of a polygon, or of a region of a mesh, in any order [m]
  std::string file;                             ///< of points, as those of -pd_cloud
  double z_lower = 0.0, z_upper = 0.0;          ///< in space: where disc, polygon and region begin and end [m]
  Vector<3> file_moved = Vector<3>::Zero();     ///< on top of what the file says [m]

  void move(const Vector<3>& by);

  /// What the shape is in a frame.
  PointShape inside(const geom::Frame& frame) const;
  /// Around it, in the plane or in space; of a file nothing [m].
  geom::Box<3> around() const;
};

/// One body of material points: `-mpm_NAME_...`.
struct PointBodyOptions {
  std::string name;
  PointShape shape;
  law::Elastic elastic;
  double spacing = 0.0;                   ///< dx of its points [m]
  Vector<3> velocity = Vector<3>::Zero(); ///< at the start [m/s]
  Vector<3> spin = Vector<3>::Zero();     ///< about its centre of mass, likewise [1/s]
};

/// How bodies of points act on each other where they meet: `-contact...`.
struct ContactOptions {
  bool active = true;
  double stiffness = 0.0; ///< modulus of the layer between two bodies; 0: that of their materials [Pa]
  double friction = 0.0;  ///< Coulomb's coefficient [-]
  bool by_sites = false;  ///< touched where points are, stairs on slanted borders, not half a spacing within the border

  static ContactOptions read(bool any_points, bool describe);
};

/// Bodies of material points: `-mpm_...`.
struct PointOptions {
  std::vector<PointBodyOptions> bodies;
  Formulation formulation = Formulation::total;
  mpm::Law law = mpm::Law::corotational;
  int ratio = 2;                        ///< cells of the grid over the spacing of points
  Coupling coupling = Coupling::energy; ///< beside particles
  double viscosity = 0.0;               ///< linear bulk viscosity b [-]
  bool skips_rest = true;               ///< of `total`: cells at rest are left out of explicit steps
  mpm::GridRule grid;                   ///< of `updated`; its side is not yet known
  ContactOptions contact;
  /// Around each body, that of elements last; of a mixed scene, once it is settled [m].
  std::vector<geom::Box<2>> regions;

  bool any() const { return !bodies.empty(); }
  /// @param elastic what bodies are of that say nothing else
  static PointOptions read(const law::Elastic& elastic, bool solid, bool describe);
};

struct SceneOptions;
/// Refuses options that have no meaning for material points. Throws UserError.
void judge_points(const SceneOptions& options);

/// Refuses what has no meaning on a grid that is made anew each step. Throws UserError.
void judge_grid(const SceneOptions& options);
} // namespace pdx::options
