#pragma once
#include "pdx/base/aligned.hpp"
#include "pdx/base/error.hpp"
#include "pdx/base/tensor.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace pdx::mpm {
/// Points that lie too far apart for one grid.
struct TooFarApart : SolverFailure {
  double speed; ///< of the fastest [m/s]
  explicit TooFarApart(double fastest) : SolverFailure("material points are too far apart for one grid"), speed(fastest)
  {}
};

/// What a point on a grid that is fixed in space is.
template <int Dim> struct GridPoint {
  Index id = 0;                         ///< among the points of its body on its rank
  Vector<Dim> at = Vector<Dim>::Zero(); ///< place, in sides of a cell from the grid's origin
  Vector<Dim> v = Vector<Dim>::Zero();  ///< [m/s]
  Tensor<Dim> h = Tensor<Dim>::Zero();  ///< F - I [-]
};

/// The points of one body on one rank by cells: eight neighbouring cells along x are the lanes of a block, and slot s
/// of a block holds the s-th point of each of them, in order of numbers. A cell reaches from `begin` behind its number
/// to where the next begins: for hats 0, where nodes are in the middle -1/2.
template <int Dim> class PointLanes {
public:
  static constexpr int kLanes = 8;
  static constexpr int kNumbers = 2 * Dim + Dim * Dim; ///< of a point: place, velocity, F - I row by row
  static constexpr std::size_t kSlot =
      kLanes * kNumbers; ///< doubles of a slot: number by number, a vector of lanes each

  struct Block {
    Site<Dim> cell{};         ///< of lane 0
    std::size_t first = 0;    ///< slot in `data`
    int slots = 0;            ///< in use
    int room = 0;             ///< slots there are
    double counts[kLanes]{};  ///< points of each cell
    std::uint8_t crossed = 0; ///< set by kernels: a point is in another cell
  };

  PointLanes() = default;
  PointLanes(double begin, std::vector<GridPoint<Dim>> points);

  /// Puts points that crossed into the cells where they are. False: some were in none, and blocks are others now.
  bool regroup();
  std::vector<GridPoint<Dim>> points() const; ///< in order of numbers
  /// Calls visit(id, its first number); the next is kLanes doubles on.
  template <class Visit> void for_each(Visit&& visit) const
  {
    for (const Block& block : blocks_)
      for (int s = 0; s < block.slots; ++s)
        for (int lane = 0; lane < kLanes; ++lane)
          if (block.counts[lane] > s) visit(ids_[at(block, s, lane)], slot(block, s) + lane);
  }
  std::size_t size() const { return size_; }

  std::span<Block> blocks() { return blocks_; }
  std::span<const Block> blocks() const { return blocks_; }
  double* slot(const Block& block, int s) { return data_.data() + (block.first + static_cast<std::size_t>(s)) * kSlot; }
  const double* slot(const Block& block, int s) const
  {
    return data_.data() + (block.first + static_cast<std::size_t>(s)) * kSlot;
  }
  /// Cells that blocks are of: from the first to the last, both within.
  const Site<Dim>& lowest() const { return lower_; }
  const Site<Dim>& highest() const { return upper_; }
  double begin() const { return begin_; }

private:
  Site<Dim> cell_of(const Vector<Dim>& at) const;
  Block* block_of(const Site<Dim>& cell); ///< null: outside
  GridPoint<Dim> taken(const Block& block, int slot, int lane) const;
  void put(const Block& block, int slot, int lane, const GridPoint<Dim>& point);
  void copy(const Block& block, int from, int to, int lane);
  void insert(Block& block, const GridPoint<Dim>& point, int lane);
  void take_out(Block& block, std::vector<GridPoint<Dim>>& out);
  void widen(Block& block);
  void settle(std::vector<GridPoint<Dim>> points);
  std::size_t at(const Block& block, int slot, int lane) const
  {
    return (block.first + static_cast<std::size_t>(slot)) * kLanes + static_cast<std::size_t>(lane);
  }

  double begin_ = 0.0;
  std::size_t size_ = 0;
  Site<Dim> lower_{}, upper_{}, count_{}; ///< cells; blocks per axis
  std::vector<Block> blocks_;             ///< x fastest
  AlignedVector<double> data_;
  std::vector<Index> ids_; ///< per slot and lane
};
} // namespace pdx::mpm
