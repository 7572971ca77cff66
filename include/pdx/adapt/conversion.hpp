#pragma once
#include "pdx/adapt/layout_change.hpp"
#include "pdx/adapt/scene_view.hpp"
#include "pdx/adapt/watch_kernel.hpp"
#include "pdx/law/elastic.hpp"

#include <functional>
#include <optional>

namespace pdx::adapt {
/// When bulk becomes particles by what it bears, not by what broke [APDMPM Eqs. 26-32].
struct ConversionRule {
  std::optional<double> stress;  ///< largest principal stress [Pa]
  std::optional<double> stretch; ///< largest principal stretch less 1: that of a bond in a uniform strain [-]
  int margin = 2;                ///< cells around one that asks that become particles too
  bool any() const { return stress || stretch; }
};

/// What cells are made of, by body (`mesh::Mesh::body`).
using ElasticOfBody = std::function<const law::Elastic&(Index body)>;

/// The cells of elements and material points of a scene that may ask, ready to be looked at after each step.
class BulkWatch {
public:
  BulkWatch(const SceneView& scene, const ConversionRule& rule, const ElasticOfBody& elastic);
  const ConversionRule& rule() const { return rule_; }
  /// Owned cells where strain or stress is above the rule's at one of four places, those of points if there are 2 x 2.
  /// @param local displacement [owned | halo] [m]
  std::vector<Index> asking(const mesh::Mesh& mesh, std::span<const double> local) const;
  /// Looks at these, ascending, no more.
  void leave_out(std::span<const Index> cells);

private:
  struct Watched {
    Index cell;
    std::array<Index, 4> rows; // local
    Vector<2> inverse;         // of the sides of a box; 0: it is none [1/m]
    law::Elastic elastic;
  };
  bool may_ask(const Watched& cell, const double* u) const;
  bool asks(const mesh::Mesh& mesh, const Watched& cell, std::span<const double> local) const;

  void append(const WatchRun& cell); // to the last run, if it goes on there

  ConversionRule rule_;
  std::vector<Watched> cells_;
  std::vector<WatchRun> runs_; // of all cells, in their order
};

/// Is there a cell that could become particles, if it asked, or none left? Collective. @param lattices as for
/// `conversion`
bool can_convert(const SceneView& scene, std::span<const geom::LatticeAnchor> lattices);

/// A box that could become particles, if its lattice divided it.
struct UndividedCell {
  Vector<2> sides;      ///< [m]
  double spacing = 0.0; ///< of the lattice [m]
};
/// The first of them, by natural numbers; none if there is none. Collective. @param lattices as for `conversion`
std::optional<UndividedCell> undivided_cell(const SceneView& scene, std::span<const geom::LatticeAnchor> lattices);

/// The cells that are to become particles: those that ask, and what lies as near to them in the same body as the margin
/// says. Cells that the lattice does not divide stay, as those next to a patch of another, and those with a held node.
/// Alike on every rank, in the order of natural numbers. Collective.
/// @param lattices where a body has no patch yet, by body   @param local displacement [owned | halo] [m]
/// @param watch leaves out what asks where nothing can be converted
std::vector<LayoutChange::Cover> conversion(const SceneView& scene, BulkWatch& watch,
                                            std::span<const geom::LatticeAnchor> lattices,
                                            std::span<const double> local);
} // namespace pdx::adapt
