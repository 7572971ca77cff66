#pragma once
#include "pdx/couple/node_field.hpp"
#include "pdx/couple/support_parts.hpp"
#include "pdx/fem/assembly.hpp"
#include "pdx/field/coarse_space.hpp"
#include "pdx/field/system.hpp"
#include "pdx/xfem/enriched_sets.hpp"

#include <unordered_map>

namespace pdx::couple {
/// A particle as the coarse level sees it: which row, in which local cell, where.
struct ParticlePlace {
  Index row;   ///< local row
  Index cell;  ///< local cell that holds it
  int patch;   ///< its patch
  Index site;  ///< number in the patch's lattice
  Vector<2> x; ///< [m]
};

/// What the rows of a scene are. All that is pointed to must outlive the coarse level.
struct FineRows {
  std::span<const Index> nodes;        ///< owned local vertices in order of their rows
  std::span<const PetscInt> node_rows; ///< global row of every local vertex, -1 under a patch
  std::vector<ParticlePlace> particles;
  const xfem::EnrichedSets* sets = nullptr; ///< null without cracks
  std::span<const std::unique_ptr<pd::LatticePart<2>>> parts;
  bool breakable = false; ///< bonds of the parts may be missing inside a patch
};

/// The whole mesh, covered cells included, as coarse level: nodes of elements are coarse rows themselves, their
/// enriched sets are seen as the value on the other side of the crack (multigrid wants two plain bodies), particles
/// hang bilinearly in the cell that holds them. One mesh, two jobs. Under a patch a crack is seen from the bonds alone:
/// a vertex has a row for each part of its particles that holds together.
class CoarseMesh final : public field::CoarseSpace {
public:
  /// Collective.
  CoarseMesh(fem::ElasticBody body, const NodeField& node_field, FineRows fine, const field::System& system);

  const field::RowHalo& halo() const override { return *halo_; }
  const field::Interpolation& interpolation() const override { return interpolation_; }
  MatHandle assemble(std::span<const double> u) override;
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
  /// A cell that is not simply an element on its four vertices.
  struct Special {
    std::vector<Index> rows;
    std::vector<double> stiffness; ///< rows x rows blocks [N/m]
  };
  /// Tells all ranks what a particle leans on at a vertex that is split.
  struct SplitRecord {
    Index natural_vertex;
    int patch;
    Index site;
    PetscInt row; ///< global coarse row, -1 for none
  };
  struct Leaning {
    int patch;
    Index site;
    PetscInt row;
  };

  void lay_out();
  std::vector<SplitRecord> split_vertices(Index& extra);
  void number(Index extra, std::span<const SplitRecord> mine);
  void sort_cells();
  void add_special(Index cell, const std::array<Corner, 4>& corners, double share, fem::ReusedStiffness& reused);
  void add_cut(const xfem::CutElement& cut);
  void interpolate();
  Corner corner(Index vertex, int patch, Index site, const Vector<2>& x) const;
  Index set_row(PetscInt fine) const;
  void hold();
  void add_springs(field::BlockAdder& adder) const;

  fem::ElasticBody body_;
  const NodeField& node_field_;
  FineRows fine_;
  const field::System& system_;
  std::vector<Index> cells_; // local cells that touch an owned vertex
  std::unique_ptr<SupportParts> support_;
  std::unordered_map<Index, Index> local_vertex_; // by natural number

  field::Rows rows_; // a row per owned vertex, then further parts, then the far sides of owned sets
  Index first_set_ = 0;
  std::unique_ptr<field::RowHalo> halo_;
  std::vector<Index> local_rows_;                         // first row of every local vertex
  std::unordered_map<Index, std::vector<Leaning>> split_; // by local vertex, ordered
  std::vector<PetscInt> fine_sets_, coarse_sets_;         // first enriched row of each rank
  std::vector<Index> extra_vertex_;                       // owned vertex of each further part
  std::vector<Index> weak_;                               // local rows of split vertices that are owned
  std::vector<Index> standard_;
  std::vector<Special> special_;
  field::Interpolation interpolation_;
  std::vector<std::uint8_t> held_; // per component of every local coarse row
  std::vector<double> leaning_;    // per component of owned coarse rows: weight of prescribed particles
};
} // namespace pdx::couple
