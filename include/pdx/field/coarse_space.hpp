#pragma once
#include "pdx/field/rows.hpp"

namespace pdx::field {
/// Each owned fine row as a combination of coarse rows, in compressed rows.
struct Interpolation {
  std::vector<std::size_t> offsets; ///< owned fine rows + 1
  std::vector<Index> columns;       ///< local coarse rows [owned | halo]
  std::vector<double> weights;
};

/// A coarse picture of the problem for two-level solvers: its own rows, operator and interpolation. Solvers do not
/// know what it is made of.
class CoarseSpace {
public:
  virtual ~CoarseSpace() = default;
  virtual const RowHalo& halo() const = 0; ///< coarse rows and those of other ranks that fine rows lean on
  virtual const Interpolation& interpolation() const = 0;
  /// Coarse operator (MATAIJ) at fine displacement u, prescribed components eliminated. Collective.
  /// @param u fine local blocks [owned | halo]
  virtual MatHandle assemble(std::span<const double> u) = 0;
  /// The first owned coarse rows, which stand for the fine nodes and enriched sets, in their order.
  virtual Index node_rows() const { return 0; }
  /// The same operator without what nodes and sets have of fixed Terms. Collective.
  virtual MatHandle assemble_rest(std::span<const double> u) { return assemble(u); }
  /// True if the operator is small and dense enough to be factored.
  virtual bool wants_factor() const { return false; }
  /// Looks at the scene again where it may have changed (bonds that broke). True if rows, interpolation or halo are
  /// new: operators and interpolations made before are then void. Collective.
  virtual bool rebuild() { return false; }
  /// Coordinates of the owned coarse rows, dim per row [m]: for rigid-body modes.
  virtual std::vector<double> coordinates() const = 0;
};
} // namespace pdx::field
