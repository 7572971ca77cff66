#pragma once
#include "pdx/base/tensor.hpp"

#include <span>
#include <vector>

namespace pdx::couple {
/// A point at the surface of a body.
template <int Dim> struct SkinPoint {
  std::uint64_t name = 0; ///< among the points of all bodies, alike on any number of ranks
  Index body = 0;
  Vector<Dim> place = Vector<Dim>::Zero(); ///< at displacement 0 [m]
  double size = 0.0;                       ///< side of its square or cube [m]
};

/// The surface points of all bodies, and the skins that span them: between points of one body that are neighbours on a
/// lattice, corners of its squares and cubes included, or as near, lie segments (in the plane) or triangles (in space).
/// Inner ones do no harm: nothing comes near. What a point touches is the skin, not the nearest point: a face is as
/// smooth as its points are in line.
template <int Dim> class ContactSkin {
public:
  /// Segment or triangle; where points have too few neighbours, a segment in space or a point.
  struct Facet {
    std::array<Index, Dim> points{}; ///< ascending, the first `count`
    int count = 0;
    double size = 0.0; ///< mean of its points [m]
  };

  ContactSkin() = default;
  /// @param points ascending by name, each name once
  ContactSkin(std::vector<SkinPoint<Dim>> points, Index bodies);

  std::span<const SkinPoint<Dim>> points() const { return points_; }
  const SkinPoint<Dim>& point(Index number) const { return points_[static_cast<std::size_t>(number)]; }
  const Facet& facet(Index number) const { return facets_[static_cast<std::size_t>(number)]; }
  Index facets() const { return static_cast<Index>(facets_.size()); }
  std::span<const Index> facets_at(Index point) const;
  /// Sizes of a body's points, ascending, each once [m].
  std::span<const double> sizes(Index body) const { return sizes_[static_cast<std::size_t>(body)]; }
  /// Length above which an edge of a facet is torn, and the facet gone [facet sizes].
  static constexpr double kTorn = 2.2;

private:
  using Neighbours = std::vector<std::vector<Index>>; // of each point, ascending
  Neighbours neighbours() const;
  void part_crossing(Neighbours& near) const;
  bool gives_way(Index p, Index q, Index r, Index s) const;
  void span_facets(const Neighbours& near);
  void add_facet(std::span<const Index> points);
  bool is_flat(Index p, Index q, Index r) const;

  std::vector<SkinPoint<Dim>> points_;
  std::vector<Facet> facets_;
  std::vector<std::size_t> first_at_; // per point and one more: of at_
  std::vector<Index> at_;             // facets of each point
  std::vector<std::vector<double>> sizes_;
};
} // namespace pdx::couple
