#pragma once
#include "pdx/mpm/point_kernel.hpp"

#include <map>
#include <utility>
#include <vector>

namespace pdx::mpm {
/// A cell as the kernel sees it.
template <int Dim> struct LocalCell {
  Index body = 0;
  CellRows<Dim> rows{}; ///< local
  std::uint64_t points = 0;
};

/// Values of the corners, of Dim values per local row.
template <int Dim> CellVector<Dim> corner_values(const LocalCell<Dim>& cell, std::span<const double> values)
{
  CellVector<Dim> corners;
  for (std::size_t a = 0; a < cell.rows.size(); ++a)
    for (std::size_t d = 0; d < Dim; ++d)
      corners[static_cast<Eigen::Index>(a * Dim + d)] = values[static_cast<std::size_t>(cell.rows[a]) * Dim + d];
  return corners;
}

/// What cells of a body with the same points have in common, each pair once. Borrows the bodies.
template <int Dim> class PointPatterns {
public:
  explicit PointPatterns(std::span<const BodyMaterial> bodies) : bodies_(bodies) {}
  const CellPoints<Dim>& of(Index body, std::uint64_t mask); ///< makes it if it is new
  const CellPoints<Dim>& at(Index body, std::uint64_t mask) const { return known_.at({body, mask}); }

private:
  std::span<const BodyMaterial> bodies_;
  std::map<std::pair<Index, std::uint64_t>, CellPoints<Dim>> known_;
};

/// Cells sorted for the kernel: by body and points; full ones in runs where their rows allow.
template <int Dim> class CellBlocks {
public:
  struct Block {
    Index body = 0;
    const CellPoints<Dim>* points = nullptr;
    std::vector<CellRun<Dim>> runs;
    std::vector<CellRows<Dim>> cells; ///< that are in no run
  };

  CellBlocks() = default;
  /// @param owned rows: a cell in a run has no others
  CellBlocks(std::vector<LocalCell<Dim>> cells, Index owned, std::span<const BodyMaterial> bodies,
             PointPatterns<Dim>& patterns);
  std::span<const Block> blocks() const { return blocks_; }

private:
  std::vector<Block> blocks_;
};
} // namespace pdx::mpm
