#pragma once
#include "pdx/coarse/patch_grid.hpp"
#include "pdx/couple/node_field.hpp"
#include "pdx/couple/support_parts.hpp"
#include "pdx/fem/assembly.hpp"
#include "pdx/field/coarse_space.hpp"
#include "pdx/field/system.hpp"
#include "pdx/xfem/enriched_sets.hpp"

#include <map>

namespace pdx::coarse {
/// What the rows of a scene are. All that is pointed to must outlive the coarse level.
struct FineRows {
  std::span<const PetscInt> node_rows;      ///< global row of every local vertex, -1 under a patch
  const xfem::EnrichedSets* sets = nullptr; ///< null without cracks
  std::span<const std::unique_ptr<pd::LatticePart<2>>> parts;
  std::span<const couple::Surroundings> around; ///< of the parts
  bool breakable = false;                       ///< bonds of the parts may be missing inside a patch
};

/// The coarse level of a scene: the elements as they are, their nodes coarse rows themselves and their enriched sets
/// seen as the value on the other side of the crack (multigrid wants two plain bodies); and a grid over each patch, on
/// which particles hang bilinearly. Under a patch a crack is seen from the bonds alone: a node of the grid has a row
/// for each part of its particles that holds together.
class CoarseMesh final : public field::CoarseSpace {
public:
  /// Collective.
  CoarseMesh(fem::ElasticBody body, const couple::NodeField& node_field, const FineRows& fine,
             const field::System& system);

  const field::RowHalo& halo() const override { return *halo_; }
  const field::Interpolation& interpolation() const override { return interpolation_; }
  MatHandle assemble(std::span<const double> u) override { return assembled(u, true); }
  Index node_rows() const override { return system_.rows.first_particle(); }
  MatHandle assemble_rest(std::span<const double> u) override { return assembled(u, false); }
  std::vector<double> coordinates() const override;
  bool rebuild() override;

private:
  /// One coarse row in a sum.
  struct Share {
    Index row; ///< local
    double factor;
    bool operator==(const Share&) const = default;
  };
  using Corner = std::vector<Share>; ///< displacement of a cell's corner as a group of particles sees it
  /// A cell that is not simply an element on its four nodes.
  struct Special {
    std::vector<Index> rows;
    std::vector<double> stiffness; ///< rows x rows blocks [N/m]
  };
  /// A cell of a grid that is looked at here.
  struct GridCell {
    int patch;
    Index cell;
    bool assembled; ///< it touches a node whose row is ours
  };
  /// Tells all ranks what a particle leans on at a node that is split.
  struct SplitRecord {
    int patch;
    Index node, site;
    PetscInt row; ///< global coarse row, -1 for none
  };
  /// How an enriched set reads in coarse rows: a = (v - u) / factor.
  struct SetRecord {
    PetscInt set, node; ///< global fine rows
    double factor;
  };
  using NodeKey = std::pair<int, Index>; ///< patch, node

  void choose_cells();
  void gather_sets();
  void lay_out();
  std::vector<SplitRecord> split_nodes(Index& extra);
  void number(Index extra, std::vector<SplitRecord> mine);
  void sort_cells();
  void add_special(const fem::ElementMatrix& stiffness, const std::array<Corner, 4>& corners);
  void add_cut(const xfem::CutElement& cut);
  void interpolate();
  Corner corner(int patch, Index node, Index site, const Vector<2>& x) const;
  Corner carried_corner(int patch, Index node, const Vector<2>& x) const;
  PetscInt coarse_of(PetscInt fine) const;
  void hold();
  void add_springs(field::BlockAdder& adder) const;
  MatHandle assembled(std::span<const double> u, bool elements) const;

  fem::ElasticBody body_;
  const couple::NodeField& node_field_;
  FineRows fine_;
  const field::System& system_;
  std::vector<PatchGrid> grids_;
  std::vector<fem::ElementMatrix> grid_stiffness_; // of an intact cell, per patch, kind of cell and law
  std::vector<std::size_t> first_kind_;            // of each patch in it
  std::vector<Index> elements_;                    // local plain cells that touch an owned vertex
  std::vector<Index> cut_;                         // likewise cut cells
  std::vector<GridCell> cells_;                    // ordered by patch and cell
  std::vector<std::vector<Index>> place_;          // per patch and cell: number in cells_, -1
  std::unique_ptr<couple::SupportParts> support_;  // null if nothing breaks
  std::map<PetscInt, SetRecord> sets_;             // by fine row of the set

  field::Rows rows_; // FE nodes, far sides of sets, owned nodes of the grids, then further parts
  std::unique_ptr<field::RowHalo> halo_;
  std::vector<Index> vertex_rows_;            // local row of every local vertex that has one
  std::vector<std::vector<Index>> grid_rows_; // per patch and node: first local row, -1 if carried or not needed
  std::map<NodeKey, std::vector<std::pair<Index, Index>>> split_; // site -> local row, ordered
  std::vector<PetscInt> fine_first_, coarse_first_;               // of each rank
  std::vector<Vector<2>> extra_points_;
  std::vector<Index> weak_;                                          // owned rows of split nodes
  std::vector<std::pair<std::size_t, std::array<Index, 4>>> intact_; // stiffness and rows of cells as they were
  std::vector<Special> special_;                                     // cut elements first
  std::size_t cut_elements_ = 0;                                     // of special_
  field::Interpolation interpolation_;
  std::vector<std::uint8_t> held_; // per component of every local coarse row
  std::vector<double> leaning_;    // per component of owned coarse rows: weight of prescribed particles
};
} // namespace pdx::coarse
