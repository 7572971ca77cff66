#pragma once
#include "pdx/mpm/cell_points.hpp"

#include <map>
#include <tuple>

namespace pdx::mpm {
/// Of each face, x low, x high, y low ...: bit k if on both sides of part k of it there are points. Parts are those
/// that sites cut it in, lower axes fastest.
template <int Dim> using SharedParts = std::array<std::uint16_t, 2 * Dim>;

/// What points of a cell are next to the parts of its faces.
template <int Dim> SharedParts<Dim> points_at_faces(int ratio, std::uint64_t mask);

/// Largest frequencies of cells at rest, for bounds D with u.K u <= sum_I D_I u_I.u_I.
///
/// Cells by themselves are stiffer than in a body: a cell that grows alike in all directions is held back by nothing.
/// In a body it is, as minors d_i u_i d_j u_j - d_j u_i d_i u_j are null Lagrangians: their integral is one over the
/// surface. A point's value times its volume is the integral over its site of what is linear in the directions of the
/// minor, so that this holds of points as well, and what neighbours have at parts of faces that both fill cancels.
/// Every cell may thus be counted without lambda times what it has there. Inside a full body no more than c_L times a
/// Laplacian is left: a step of h / c_L, as of the lattice.
template <int Dim> class CellBounds {
public:
  /// Borrows the body.
  explicit CellBounds(const BodyMaterial& body) : body_(body) {}
  /// lambda with (K - what is shared) <= lambda diag(weights). Calls with the same numbers, to 1e-12, cost one search.
  /// @param weights per corner, the largest about 1
  double stiffest(const CellPoints<Dim>& points, const SharedParts<Dim>& shared, const CornerValues<Dim>& weights);

private:
  using Weights = std::array<std::int64_t, static_cast<std::size_t>(kCorners<Dim>)>;
  const BodyMaterial& body_;
  std::map<std::pair<std::uint64_t, SharedParts<Dim>>, CellMatrix<Dim>> matrices_;
  using Key = std::tuple<std::uint64_t, SharedParts<Dim>, Weights>;
  std::map<Key, double> known_;
  const std::pair<const Key, double>* last_ = nullptr; // of known_: of that cells inside a body mostly ask again
};
} // namespace pdx::mpm
