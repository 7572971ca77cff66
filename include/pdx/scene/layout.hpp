#pragma once
#include "pdx/adapt/layout_change.hpp"
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/sealed_reader.hpp"
#include "pdx/options/scene_options.hpp"

namespace pdx::scene {
/// Where the lattices of bodies begin that have no patch yet, by body. The scene is settled, and has one spacing.
std::vector<geom::LatticeAnchor> body_lattices(const options::SceneOptions& options);

/// What of a scene may change while it runs, from the body's corner: where its patches lie and where its cracks run.
struct Layout {
  std::vector<geom::Box<2>> patches; ///< boxes of particles; none where all of the body is one patch [m]
  std::vector<double> spacing;       ///< of each [m]
  std::vector<crack::Polyline> cracks;
  std::vector<geom::LatticeAnchor> anchors; ///< of the patches that were given: sites are named by them
  std::vector<geom::Box<2>> regions;        ///< around bodies, whose patches stay apart; none: there is one body [m]
  std::optional<std::vector<mpm::GridPlace<3>>>
      cells; ///< that are particles, ascending; bodies of points in space only

  /// That of the options, settled.
  static Layout given(const options::SceneOptions& options);
  /// The options of a scene with this layout.
  options::SceneOptions in(options::SceneOptions options) const;
  /// Another, in which some cells have changed hands.
  Layout changed(const adapt::LayoutChange& change) const;

  /// Its tables in a checkpoint. Collective.
  void write(io::Hdf5File& file) const;
  /// Throws UserError for tables that make no layout, or another than the scene was given. Where patches move they may
  /// lie elsewhere, and cracks go on from their tips. Collective.
  /// @param options settled
  static Layout read(const io::SealedReader& file, const options::SceneOptions& options);
};
} // namespace pdx::scene
