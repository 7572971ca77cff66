#pragma once
#include "crack_net.hpp"
#include "pdx/xfem/pieces.hpp"

namespace pdx::xfem {
/// What hangs together of a cell.
struct CellPart {
  std::vector<geom::Polygon> outlines;     ///< convex [m]
  double area = 0.0;                       ///< [m^2]
  std::vector<std::pair<int, Side>> sides; ///< of cracks that bound it or run through the cell
  int taken_by = -1; ///< part of the cell that it moves with, though a crack lies between; -1: none

  std::optional<Side> side_of_crack(int crack) const;
};

/// A cell as cracks part it.
class PartedCell {
public:
  /// A part of the cell's border.
  struct Share : NetShare {
    int part;  ///< whose it is, whatever that moves with
    bool held; ///< that moves what lies across, unless `open`: not so where a snapped crack let go of it
  };

  /// @param number its place in the net   @param cuts of this cell   @param obey_snaps snapped cracks part nothing
  PartedCell(const CrackNet& net, std::size_t number, Index cell, const fem::Corners& corners,
             std::span<const PieceCut> cuts, const crack::CrackSet& cracks, bool obey_snaps);

  Index cell() const { return cell_; }
  std::span<const PieceCut> cuts() const { return cuts_; }
  const std::vector<CellPart>& parts() const { return parts_; }
  const std::vector<Share>& border() const { return border_; }
  const std::set<int>& parting() const { return parting_; } ///< cracks with parts on both sides

  /// Makes a part move with another one of the cell.
  void take(int part, int by) { parts_[static_cast<std::size_t>(part)].taken_by = by; }
  /// What a part moves with in the end.
  int mover_of(int part) const;
  /// The part of `among` with most of its outline along this one's; -1: none.
  int neighbour_of(int part, const std::vector<int>& among) const;

private:
  Index cell_;
  std::vector<PieceCut> cuts_;
  std::vector<CellPart> parts_;
  std::vector<Share> border_;
  std::set<int> parting_;
  std::map<std::pair<int, int>, double> shared_; // length of walls between two parts, the lower first [m]
};
} // namespace pdx::xfem
