#pragma once
#include "pdx/pd/lattice_part.hpp"
#include "pdx/pd/strip_kernel.hpp"

#include <limits>

namespace pdx::pd {
/// A LatticePart laid out for explicit steps: lane strips (StripView) of its window in tiles. Tiles without bonds are
/// never looked at, and those that rest, with all that they reach, are skipped in a step. The LatticePart stays the
/// truth about bonds: what breaks here is handed to it.
template <int Dim> class StripPart {
public:
  StripPart(LatticePart<Dim>& part, Kinematics kinematics, Processor processor = chosen_processor());

  /// From now on forces look for bonds with s > critical_stretch. Infinity: nothing breaks.
  /// @param critical_stretch of the patch; bonds of regions have theirs in proportion
  void watch(double critical_stretch);
  /// Tiles count as at rest where no displacement component exceeds this size [m]. 0 changes no result; below 0 nothing
  /// is skipped.
  void skip_below(double displacement) { at_rest_ = displacement; }

  /// Takes the displacement of the owned rows (interleaved, from local row 0) and fetches the halo. Collective.
  void load(std::span<const double> owned);
  /// r_i += internal force at the displacement loaded last, as `add_force` of bond_kernel.hpp.       [N]
  /// @param r rows of Dim; nullptr: only look for overstretched bonds
  void add_force(double* r) { sweep(r, false); }
  /// Strain energy of this rank's particles there, half of each bond's for either end; adds forces in the same pass.
  /// @param r as above                                                                               [J]
  double energy(double* r = nullptr);

  /// True if the last pass saw a bond of this rank that may be overstretched.
  bool overstretched_seen() const;
  /// Takes out the overstretched bonds at the displacement loaded last, where the last pass saw any: those that
  /// LatticePart::break_bonds would. @return what this rank counts
  Broken break_bonds(field::ForceLosses* losses = nullptr);
  /// Reads all bonds of the LatticePart again, after it changed by other means.
  void take_over_words();
  /// The rows of the LatticePart are so many further from now on; passes are counted anew.
  void move_rows(Index by);

  std::int64_t tiles_computed() const { return computed_; } ///< tiles with bonds, summed over all passes
  std::int64_t tiles_skipped() const { return skipped_; }

private:
  /// 0 at first, aligned for vectors.
  template <class T> class Aligned {
  public:
    void resize(std::ptrdiff_t size) { lines_.assign(static_cast<std::size_t>(size + 7) / 8, Line{}); }
    T* data() { return reinterpret_cast<T*>(lines_.data()); }

  private:
    struct alignas(64) Line {
      T entries[8];
    };
    std::vector<Line> lines_;
  };
  /// Neighbouring rows of one tile and strip.
  struct Piece {
    std::ptrdiff_t at; ///< of the first one's first component in the blocks
    Index row, length;
    int tile;
    bool filled; ///< its displacements were not always all 0
  };
  struct Spot {
    std::ptrdiff_t vector, line;
    int lane, column;
  };
  struct HaloSite {
    std::ptrdiff_t at;
    int tile;
  };

  Spot spot(std::ptrdiff_t window) const;
  std::ptrdiff_t block(const Spot& spot) const { return spot.vector * StripView<Dim>::kParts * lanes_ + spot.lane; }
  int tile_of(const Spot& spot) const;
  void lay_out();
  void lay_arms();
  void lay_tiles();
  void lay_pieces();
  void lay_factors();
  double limit_of(double stretch) const;
  double threshold(std::size_t tile) const { return thresholds_.empty() ? threshold_ : thresholds_[tile]; }
  void watch_tiles();
  bool is_over(std::ptrdiff_t site, std::size_t arm, const Vector<Dim>& eta) const;
  void lay_ends();
  void shrink_boxes();
  std::vector<std::uint8_t> around(const std::vector<std::uint8_t>& tiles) const;
  void load_piece(Piece& piece, const double* owned);
  void choose_tiles();
  /// Where the parts of one slab of tiles (last direction) are. Bonds lead from a slab to itself and those after it.
  struct Slab {
    std::size_t tasks = 0, lines = 0, pieces = 0; ///< the first one in chosen_tasks_, touched_lines_, pieces_
  };
  Index slabs() const { return tiles_[Dim - 1]; }
  Index slabs_reached() const { return (stencil_reach_ + span_[Dim - 1] - 1) / span_[Dim - 1]; }
  std::span<StripTask> tasks_of(Index slab);
  StripLines lines_of(Index slab) const;
  void prepare(Index slab);
  void sweep(double* r, bool energetic);
  void sweep_slab(Index slab, bool energetic);
  void unload(Index slab, double* r) const;

  LatticePart<Dim>& part_;
  Kinematics kinematics_;
  Processor processor_;
  int lanes_;
  double critical_stretch_ = std::numeric_limits<double>::infinity();
  double threshold_ = std::numeric_limits<double>::infinity(); // of StripTask::highest, with room for rounding
  std::vector<double> thresholds_; // of each tile, where regions differ in it; empty: threshold_
  double least_stretch_ = std::numeric_limits<double>::infinity(); // of any bond, where they differ
  double at_rest_ = 0.0;

  int stencil_reach_ = 0, columns_ = 0; // columns: length of a strip
  std::ptrdiff_t pitch_ = 0, vectors_ = 0;
  std::array<Index, Dim> extent_{};         // sites of the window; x without padding
  std::array<Index, Dim> tiles_{}, span_{}; // tiles per direction; lines of one (span_[0] is not used)
  std::vector<Index> column_ends_;          // of the column tiles
  std::vector<StripArm<Dim>> arms_;
  Aligned<double> blocks_, ends_, factors_;
  std::vector<std::uint16_t> classes_; // per vector; empty: no bond has a surface factor
  std::array<Aligned<std::uint64_t>, 2> words_;
  std::array<Aligned<std::uint64_t>, 2> breakable_; // words_ without protected bonds; empty if none is
  StripView<Dim> view_;
  std::vector<Piece> pieces_;
  std::vector<HaloSite> halo_;

  std::vector<StripTask> tasks_;              // of all tiles; columns 0: no bonds
  std::vector<std::uint8_t> busy_, touched_;  // per tile: is displaced; may get forces
  std::vector<std::size_t> chosen_;           // tiles to compute, ascending
  std::vector<StripTask> chosen_tasks_;       // theirs
  std::vector<std::ptrdiff_t> touched_lines_; // ascending
  std::vector<Slab> slab_;                    // and the end of the last one
  std::vector<StripBond> found_;
  std::int64_t computed_ = 0, skipped_ = 0;
};
} // namespace pdx::pd
