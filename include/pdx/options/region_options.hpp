#pragma once
#include "pdx/geom/frame.hpp"
#include "pdx/law/regions.hpp"
#include "pdx/options/materials.hpp"

#include <memory>
#include <optional>

namespace pdx::options {
struct FractureOptions;

inline constexpr const char* kRest = "rest"; ///< what lies in no region, among names of regions

/// A part of the body of another material: `-region_NAME_...`.
struct RegionOptions {
  std::string name;
  std::vector<geom::Outline::Edge> border; ///< as given [m]
  law::Elastic elastic;
  std::optional<double> toughness; ///< none: as -material_toughness [J/m^2]
  bool no_fail = false;            ///< no bond with an end in it breaks
};

/// All regions of a scene, and the interfaces between them: `-interface_NAME_...`.
struct RegionSetOptions {
  std::vector<RegionOptions> regions;
  std::vector<law::Interface> interfaces;

  bool any() const { return !regions.empty(); }
  /// The largest energy release rate that a region or an interface has; none: none has one. [J/m^2]
  std::optional<double> toughness() const;
  /// What the scene is made of, with coordinates of the frame; null where there are no regions.
  std::shared_ptr<const law::Regions> settled(const geom::Frame& frame, const law::Elastic& rest,
                                              const FractureOptions& fracture) const;

  /// @param rest what is not given is that of this   @param particles are there any? Their Poisson's ratio is that of
  ///        `rest`, and without them nothing breaks
  static RegionSetOptions read(const Materials& materials, const law::Elastic& rest, bool particles, bool describe);
};

struct SceneOptions;
/// Refuses what cannot stand beside regions. Throws UserError.
void judge_regions(const SceneOptions& options);
/// Of regions that change nothing.
std::vector<std::string> region_warnings(const SceneOptions& options);
} // namespace pdx::options
