#pragma once
#include "pdx/xfem/pieces.hpp"

namespace pdx::xfem {
/// A convex part of a cell between cracks.
struct CellPart {
  geom::Polygon outline;                   ///< [m]
  std::vector<std::pair<int, Side>> sides; ///< of cracks that bound it or cut the cell elsewhere
  int joined_to = -1;                      ///< part of the same cell that no crack parts it from; -1: none
  int taken_by = -1; ///< likewise, though a crack does: a sliver that lets go of its edges; -1: none
  bool is_own() const { return joined_to < 0 && taken_by < 0; }

  std::optional<Side> side_of_crack(int crack) const;
};

/// A cell as cracks part it.
class PartedCell {
public:
  /// @param cuts of this cell; none for a whole one
  PartedCell(Index cell, const fem::Corners& corners, std::span<const PieceCut> cuts);

  Index cell() const { return cell_; }
  const fem::Corners& corners() const { return corners_; }
  std::span<const PieceCut> cuts() const { return cuts_; }
  std::vector<CellPart>& parts() { return parts_; }
  const std::vector<CellPart>& parts() const { return parts_; }

  /// Fractions of an edge at which cracks cross it, between 0 and 1, ascending.
  const std::vector<double>& crossings(int edge) const { return crossings_[static_cast<std::size_t>(edge)]; }
  /// The part that has an edge at a fraction of it, whatever it moves with.
  int owner_at(int edge, double fraction) const;
  /// The same, -1 where the part lets go of the edge: it moves with what lies across a crack.
  int part_at(int edge, double fraction) const;
  /// What a part moves with in the end.
  int mover_of(int part) const;
  /// The part that shares most of its outline with this one, of those that move by themselves; -1: none.
  int neighbour_of(int part) const;

private:
  struct Chord {
    int crack;
    Vector<2> from, to; ///< [m]
  };
  Vector<2> on_edge(int edge, double fraction) const;
  Vector<2> crossing_of(const PieceCut& cut, int edge) const;
  Side side_on_edge(const PieceCut& cut, int edge, double fraction) const;
  geom::Polygon left_of(const geom::Polygon& outline, const Vector<2>& from, const Vector<2>& along) const;
  const Chord* chord_of(int crack) const;
  void run_through(const PieceCut& cut);
  bool end_on(const PieceCut& cut);
  bool pair(std::vector<const PieceCut*>& ends);
  bool star(const std::vector<const PieceCut*>& ends);
  void divide(const Chord& chord, const Vector<2>& to_plus, const std::pair<int, Side>* within);

  Index cell_;
  fem::Corners corners_;
  std::vector<PieceCut> cuts_;
  double tiny_; ///< rounding of places [m]
  std::vector<Chord> chords_;
  std::vector<CellPart> parts_;
  std::array<std::vector<double>, 4> crossings_;
};
} // namespace pdx::xfem
