#pragma once
#include "pdx/geom/box.hpp"
#include "pdx/mpm/cell_shape.hpp"
#include "pdx/mpm/point_cells.hpp"

#include <functional>
#include <string>
#include <vector>

namespace pdx::mpm {
/// A body of material points in its reference state: sites of a lattice that lie in its shape, dealt to the cells of
/// its own grid. Alike on every rank.
template <int Dim> struct Body {
  std::string name;
  BodyMaterial material;
  Vector<Dim> corner = Vector<Dim>::Zero(); ///< of the grid [m]
  Site<Dim> cells{};                        ///< of the grid, per direction
  std::vector<std::uint64_t> points;        ///< as PointCell::points, for each cell, x fastest; 0: none is in it
  /// Of a shape whose border runs across the lattice: where the skin of the body is beside a site, half a spacing
  /// within the border. Directions that no other point covers are bits. Empty: at the site itself.
  std::function<Vector<Dim>(const Vector<Dim>& site, unsigned uncovered)> skin;

  double cell_size() const { return material.ratio * material.spacing; } ///< h [m]
  std::int64_t number(const Site<Dim>& cell) const;
  Site<Dim> cell(std::int64_t number) const;
  /// 0 outside the grid.
  std::uint64_t points_in(const Site<Dim>& cell) const;
  Vector<Dim> node(const Site<Dim>& at) const; ///< place of a node of the grid [m]
  /// Place of a site of a cell. @param site x fastest [m]
  Vector<Dim> place(const Site<Dim>& cell, int site) const;
  /// Place of a site of the lattice, counted from the corner [m].
  Vector<Dim> place_of(const Site<Dim>& site) const;
  std::int64_t count() const; ///< of its points
  /// Mean place of its points [m].
  Vector<Dim> centre() const;
  /// Around the squares or cubes that its points stand for [m].
  geom::Box<Dim> around() const;
  /// Calls visit(x) for every point, x fastest in cells and in each [m].
  template <class Visit> void for_each_place(Visit&& visit) const
  {
    for (std::size_t k = 0; k < points.size(); ++k)
      for_each_point(points[k], [&](int site) { visit(place(cell(static_cast<std::int64_t>(k)), site)); });
  }
  /// Is a point on that site of the lattice? Counted from the corner, any number.
  bool has(const Site<Dim>& site) const;
  /// The directions, bit by bit, along which the point on a site of a cell has a side that no other point covers.
  unsigned uncovered(const Site<Dim>& cell, int site) const;
  /// Place of the skin that the point on a site at the surface stands for [m].
  Vector<Dim> skin_place(const Site<Dim>& cell, int site) const;
};

/// Fills a body: its points are the sites whose centres lie in the shape.
/// @param reach what the grid must cover at least; its lower corner is that of grid and lattice [m]
/// Throws UserError for no point at all, and for more cells than can be counted.
template <int Dim>
Body<Dim> fill_body(std::string name, const BodyMaterial& material, const geom::Box<Dim>& reach,
                    const std::function<bool(const Vector<Dim>&)>& inside);

} // namespace pdx::mpm
