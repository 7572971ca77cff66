#pragma once
#include "pdx/base/options.hpp"
#include "pdx/couple/schemes.hpp"
#include "pdx/fem/element.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/geom/same_lattice.hpp"
#include "pdx/law/elastic.hpp"
#include "pdx/mesh/build.hpp"
#include "pdx/mpm/grid_cell.hpp"
#include "pdx/options/condition_options.hpp"
#include "pdx/options/fracture_options.hpp"
#include "pdx/options/point_options.hpp"
#include "pdx/options/probe_options.hpp"
#include "pdx/options/region_options.hpp"
#include "pdx/options/thermal_options.hpp"
#include "pdx/options/time_options.hpp"
#include "pdx/pd/stencil.hpp"

namespace pdx::options {
/// How strains are measured. small: linear bonds and elements. finite: finite-stretch bonds and St Venant-Kirchhoff
/// elements. mixed: the papers' finite bonds with linear elements.
enum class KinematicsOption { small, finite, mixed };
/// Of bonds at free surfaces. exact: `pd::SideWeights`, in space `pd::SolidSides`. volume: the papers'. automatic:
/// exact where it can be, else by volume.
enum class SurfaceCorrection { automatic, none, volume, exact };
enum class PdOperator { automatic, matrix_free, assembled };

inline constexpr const char* kMeshBody = "mesh"; ///< what elements are called among bodies

struct PdOptions {
  bool everywhere = false;           ///< -pd_patches all
  std::vector<geom::Box<2>> patches; ///< [m]
  std::vector<geom::Box<3>> boxes;   ///< the same in space, of bodies of material points [m]
  std::vector<mpm::GridPlace<3>>
      cells;                   ///< of the grids of these that are particles, once the scene is settled; ascending
  std::string cloud;           ///< file of particles that lie anywhere; they stand alone
  double horizon = 0.0;        ///< of a cloud [m]
  std::vector<double> spacing; ///< one, or one per patch [m]
  std::vector<geom::LatticeAnchor>
      anchors; ///< lattices of the patches that were given, twice or more is once; none: of `patches`
  double horizon_ratio = 4.0;
  law::Micromodulus micromodulus = law::Micromodulus::conical;
  pd::Calibration calibration = pd::Calibration::lattice;
  SurfaceCorrection surface_correction = SurfaceCorrection::automatic;
  PdOperator solver = PdOperator::automatic;
  double skip_tolerance = 0.0; ///< explicit: bonds whose displacements do not exceed it are skipped; below 0: none [m]
  bool seeded = false;         ///< -adapt_seed tip: `patches` lie at the tips of cracks, once the scene is settled
  bool to_come = false;        ///< there may be none until bulk is converted
  bool any() const { return everywhere || !patches.empty() || !boxes.empty() || !cloud.empty() || seeded || to_come; }
  bool bordered() const { return any() && !everywhere && cloud.empty(); } ///< do elements lie around patches?
  double spacing_of(std::size_t patch) const { return spacing.size() == 1 ? spacing[0] : spacing[patch]; }
};

struct OutputOptions {
  std::string directory; ///< of all files; of a dry run one of its own below
  bool dry_run = false;  ///< build, measure, write the initial fields, and no more
  bool warnings_are_errors = false;
  bool pictures = false; ///< fields were asked for, which a dry run writes anyway
  bool fields = false, history = false, quiet = false;
  bool vtkhdf = false;       ///< describe the fields as VTKHDF too, at the end
  int interval = 1;          ///< accepted steps from one set of fields to the next; the last is always written
  std::vector<double> times; ///< fields at the steps nearest to them as well, ascending [s]
  int history_interval = 1;  ///< steps from one row of history.csv, and one look at the energies, to the next

  static OutputOptions read(const std::string& case_name, bool dynamic);
};

/// All that a user may say about a scene; read once, judged once, refused not mended.
struct SceneOptions {
  std::string case_name = "case";
  geom::Frame frame; ///< of all coordinates below: as given until `settle`
  mesh::MeshOptions mesh;
  law::Elastic elastic;
  RegionSetOptions region_set;                 ///< as given
  std::shared_ptr<const law::Regions> regions; ///< null until `settle`, and where all is of one material
  bool solid = false;                          ///< in space: the body in the plane, extruded by the thickness
  KinematicsOption kinematics = KinematicsOption::small;
  PdOptions pd;
  PointOptions points;
  couple::Scheme scheme = couple::Scheme::energy;
  bool face_mass = false; ///< particles hand mass to where their bonds leave a patch
  CrackOptions cracks;
  FractureOptions fracture;
  ThermalOptions thermal;
  std::vector<BoundaryCondition> conditions;
  LoadOptions load;
  TimeOptions time;
  LayoutOptions layout;
  PostOptions post;
  OutputOptions output;
  std::vector<ProbeOptions> probes;
  std::vector<std::string> warnings; ///< of what was taken otherwise than written
  std::vector<std::string> notes;    ///< of what was chosen because nothing was written

  /// Do bodies of material points stand beside elements or particles, or at rest in the plane, where they are cells of
  /// a mesh too?
  bool mixed() const
  {
    return points.any() && !solid &&
           (pd.any() || mesh.cells[0] > 0 || !mesh.file.empty() || converts() || !time.dynamic());
  }
  /// Do they in space, where all else is particles on cells of their grids?
  bool mixed_in_space() const { return points.any() && solid && (pd.any() || converts()); }
  /// May bulk become particles where no patch is?
  bool converts() const { return layout.adapt != Adapt::none && layout.triggers.any(); }
  law::Kinematics bond_kinematics() const
  {
    return kinematics == KinematicsOption::small ? law::Kinematics::small : law::Kinematics::finite;
  }
  law::Kinematics element_kinematics() const
  {
    return kinematics == KinematicsOption::finite ? law::Kinematics::finite : law::Kinematics::small;
  }

  /// Throws UserError, alike on every rank. With `describe` nothing is judged: for -help.
  static SceneOptions read(bool describe = false);
};

/// Refuses options that have no meaning for a cloud. Throws UserError.
void judge_cloud(const SceneOptions& options);
} // namespace pdx::options
