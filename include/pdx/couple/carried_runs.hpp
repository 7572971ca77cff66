#pragma once
#include "pdx/base/aligned.hpp"
#include "pdx/couple/carried_points.hpp"
#include "pdx/couple/run_kernel.hpp"
#include "pdx/couple/run_order.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace pdx::couple {
/// Bonds laid out in runs: along a straight side all particles of one depth have the same bonds, each one place further
/// on. Bonds that meet the side in the same points of its lattice cells share these, however many depths and arms they
/// come from, and those that go from one particle to the same point are one. A tile is a piece of a side, with a
/// scratch that stays in the nearest cache. What is too short or too irregular for lanes is left out.
template <int Dim> class CarriedRuns {
public:
  CarriedRuns() = default;
  /// @param points bound; those of the bonds   @param owned rows of this rank
  CarriedRuns(const CarriedPoints<Dim>& points, std::span<const RunBond<Dim>> bonds, Index owned);

  /// So many rows are owned from now on, and all bonds are of this patch.
  void number(Index owned, Index patch)
  {
    owned_ = owned;
    for (Index& of : patches_)
      if (of >= 0) of = patch;
  }
  /// Local rows are others from now on, in the same order. @param now of each local row before
  void move_rows(std::span<const Index> now)
  {
    const auto move = [now](Index& row) {
      if (row >= 0) row = now[static_cast<std::size_t>(row)];
    };
    for (RunParticles& some : particles_) move(some.row);
    for (std::vector<Index>* rows : {&rows_, &particle_rows_}) std::ranges::for_each(*rows, move);
  }

  /// Numbers of the bonds that are in runs.
  const std::vector<std::size_t>& numbers() const { return numbers_; }
  /// @param stiffness of a bond by its number: kappa / |xi|, 0 if it is gone [N/m]
  template <class Stiffness> void set_stiffness(Stiffness&& stiffness)
  {
    std::fill(stiffness_.begin(), stiffness_.end(), 0.0);
    for (std::size_t k = 0; k < numbers_.size(); ++k)
      stiffness_[static_cast<std::size_t>(lanes_[k])] += stiffness(numbers_[k]);
  }
  /// @param limit of a patch and a bond's `stretch`, what growth is watched for (`Run::limit`); bonds that never fail
  /// are not [-]
  template <class Limit> void set_limits(Limit&& limit)
  {
    for (std::size_t k = 0; k < runs_.size(); ++k)
      runs_[k].limit = patches_[k] < 0 ? std::numeric_limits<double>::infinity() : limit(patches_[k], stretches_[k]);
  }

  /// r += forces of the bonds on owned rows at displacement u. @return was a limit passed?
  bool add_forces(Processor processor, bool finite, std::span<const double> u, std::span<double> r) const;
  /// Of the bonds from owned rows at displacement u [J].
  double energy(Processor processor, bool finite, std::span<const double> u) const;

private:
  struct Line;
  struct Piece;
  class Tile;
  RunView<Dim> view() const;
  void add(const Tile& tile, const CarriedPoints<Dim>& points);
  void add_particles(const Line& line, Index scratch);
  void add_points(const Line& line, Index scratch, const CarriedPoints<Dim>& points, std::span<const Index> rows);
  void add_run(const Piece& piece, Index from, Index to);
  std::ptrdiff_t place_weights(std::vector<double> weights);

  Index owned_ = 0;
  std::vector<RunTile> tiles_;
  std::vector<RunParticles> particles_;
  std::vector<RunPoints> points_;
  std::vector<Run<Dim>> runs_;
  std::vector<Index> patches_;    // per run, -1: its bonds never fail
  std::vector<double> stretches_; // per run
  std::vector<Index> rows_, particle_rows_, hosts_;
  AlignedVector<double> weights_, stiffness_;
  std::vector<std::size_t> numbers_;
  std::vector<std::ptrdiff_t> lanes_;                                 // per number: its stiffness
  std::map<std::vector<std::int64_t>, std::ptrdiff_t> known_weights_; // rounded; where they are
  mutable AlignedVector<double> scratch_, sums_;
  mutable std::vector<std::uint8_t> far_; // per tile
};
} // namespace pdx::couple
