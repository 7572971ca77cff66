#pragma once
#include "pdx/crack/crack_set.hpp"
#include "pdx/track/bond_graph.hpp"

#include <map>
#include <set>

namespace pdx::test {
/// Particles of a rectangle with bonds that are gone; sites from 0 on.
class CrackedLattice {
public:
  using Bond = std::pair<Site<2>, Site<2>>; ///< lower site first

  /// @param ratio horizon over spacing
  CrackedLattice(const Site<2>& count, double ratio, double dx = 1.0, const Vector<2>& origin = Vector<2>::Zero())
      : lattice{origin, dx, count}
  {
    pd::StencilOptions options;
    options.dx = dx;
    options.horizon = ratio * dx;
    options.elastic.young = 1.0;
    options.elastic.poisson = 1.0 / 3.0;
    stencil = pd::make_stencil<2>(options);
  }

  Vector<2> upper() const { return lattice.origin + lattice.dx * Vector<2>(lattice.count[0], lattice.count[1]); }
  double horizon() const { return stencil.horizon; }

  /// Takes out all bonds that cross a polyline [m].
  CrackedLattice& cut(const crack::Polyline& points)
  {
    const crack::CrackSet cracks({points}, {lattice.origin, upper()});
    for_each_bond([&](const Bond& bond) {
      const Vector<2> a = lattice.point(bond.first);
      if (cracks.near(a, stencil.horizon) && cracks.cuts(a, lattice.point(bond.second))) gone.insert(bond);
    });
    return *this;
  }

  template <class Visit> void for_each_bond(Visit&& visit) const
  {
    for (Index k = 0; k < static_cast<Index>(lattice.total()); ++k)
      for (const pd::Arm<2>& arm : stencil.half) {
        const Site<2> a = lattice.site(k), b{a[0] + arm.step[0], a[1] + arm.step[1]};
        if (lattice.contains(b)) visit(Bond{a, b});
      }
  }

  /// As bond words say it.
  track::BondGraph graph() const
  {
    track::BondGraph made(lattice, stencil, [whole = lattice](const Site<2>& site) { return whole.contains(site); });
    std::map<Site<2>, std::array<std::uint64_t, 2>> words;
    for (const auto& [a, b] : gone)
      for (std::size_t h = 0; h < stencil.half.size(); ++h)
        if (stencil.half[h].step == Site<2>{b[0] - a[0], b[1] - a[1]}) words[a][h / 64] |= std::uint64_t{1} << h % 64;
    for (const auto& [site, word] : words) made.add(site, word);
    return made;
  }

  /// All cells of `across` by `up` spacings.
  std::vector<geom::Box<2>> cells(Index across, Index up) const
  {
    std::vector<geom::Box<2>> all;
    for (Index j = 0; j + up <= lattice.count[1]; j += up)
      for (Index i = 0; i + across <= lattice.count[0]; i += across)
        all.push_back({lattice.origin + lattice.dx * Vector<2>(i, j),
                       lattice.origin + lattice.dx * Vector<2>(i + across, j + up)});
    return all;
  }

  geom::Lattice<2> lattice;
  pd::Stencil<2> stencil;
  std::set<Bond> gone;
};
} // namespace pdx::test
