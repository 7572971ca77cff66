#pragma once
#include "pdx/geom/clip.hpp"
#include "pdx/geom/site_set.hpp"

#include <cstdlib>

namespace pdx::geom {
/// A lattice cell that a line from the middle of one cell to that of another runs through, counted from the first, and
/// the part of the line in it, 0 at its beginning and 1 at its end.
template <int Dim> struct LinePiece {
  Site<Dim> cell{};
  double enter = 0.0, leave = 1.0; ///< the nearest numbers to the exact ratios [-]
};

/// All cells in order. Which lattice lines are crossed first is decided in whole numbers: a line through a corner of
/// cells goes on in the cell opposite.
template <int Dim> std::vector<LinePiece<Dim>> pieces_of_line(const Site<Dim>& step)
{
  std::vector<LinePiece<Dim>> pieces(1);
  Site<Dim> crossed{}; // lattice lines per direction; the next is crossed at (2 crossed + 1) / (2 |step|)
  const auto count = [&](std::size_t d) { return static_cast<std::int64_t>(std::abs(step[d])); };
  const auto order = [&](std::size_t d, std::size_t e) { // of the next crossings
    return (2 * crossed[d] + 1) * count(e) - (2 * crossed[e] + 1) * count(d);
  };
  for (;;) {
    std::size_t next = Dim;
    for (std::size_t d = 0; d < Dim; ++d)
      if (crossed[d] < count(d) && (next == Dim || order(d, next) < 0)) next = d;
    if (next == Dim) return pieces;
    Site<Dim> beyond = crossed;
    LinePiece<Dim> piece = pieces.back();
    for (std::size_t d = 0; d < Dim; ++d)
      if (crossed[d] < count(d) && order(d, next) == 0) {
        ++beyond[d];
        piece.cell[d] += step[d] > 0 ? 1 : -1;
      }
    piece.enter = pieces.back().leave =
        static_cast<double>(2 * crossed[next] + 1) / static_cast<double>(2 * count(next));
    crossed = beyond;
    pieces.push_back(piece);
  }
}

template <int Dim> Site<Dim> cell_at(Site<Dim> from, const LinePiece<Dim>& piece)
{
  for (std::size_t d = 0; d < Dim; ++d) from[d] += piece.cell[d];
  return from;
}

/// Does the line from a site lie in the cells of a set, borders included?
template <int Dim>
bool runs_inside(const SiteSet<Dim>& set, const Site<Dim>& from, std::span<const LinePiece<Dim>> line)
{
  if (set.is_box()) return set.has(from) && set.has(cell_at<Dim>(from, line.back()));
  for (const LinePiece<Dim>& piece : line)
    if (!set.has(cell_at<Dim>(from, piece))) return false;
  return true;
}

/// Does the line come into the cells of a set on its way, from outside?
template <int Dim> bool comes_in(const SiteSet<Dim>& set, const Site<Dim>& from, std::span<const LinePiece<Dim>> line)
{
  bool in = set.has(from);
  for (const LinePiece<Dim>& piece : line.subspan(1)) {
    const bool here = set.has(cell_at<Dim>(from, piece));
    if (here && !in) return true;
    in = here;
  }
  return false;
}

/// A part of a line in the cells of a set: from one border to another, or from or to its end.
struct PartInside {
  Clip clip;
  int first = 0; ///< piece of the line with which it begins
};

template <int Dim>
std::vector<PartInside> parts_inside(const SiteSet<Dim>& set, const Site<Dim>& from,
                                     std::span<const LinePiece<Dim>> line)
{
  std::vector<PartInside> parts;
  bool in = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const bool here = set.has(cell_at<Dim>(from, line[k]));
    if (here && !in) parts.push_back({{line[k].enter, line[k].leave}, static_cast<int>(k)});
    if (here) parts.back().clip.leave = line[k].leave;
    in = here;
  }
  return parts;
}
} // namespace pdx::geom
