#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/law/bond_force.hpp"
#include "pdx/pd/breaker.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <functional>
#include <limits>

namespace pdx::test {
/// A patch that nothing surrounds: a lattice, its bonds, and who owns which site. E = 3, nu = 1/3, thickness 0.5.
struct BarePatch {
  MPI_Comm comm;
  field::Rows rows;
  std::vector<std::unique_ptr<pd::LatticePart<2>>> parts; ///< one

  /// @param owner rank of a site number; empty: all sites belong to rank 0 of the communicator. Collective.
  BarePatch(MPI_Comm on, const geom::Lattice<2>& lattice, double horizon_ratio,
            const std::function<int(Index site)>& owner = {})
      : comm(on)
  {
    int rank = 0;
    MPI_Comm_rank(comm, &rank);
    std::vector<Index> sites;
    for (Index site = 0; site < static_cast<Index>(lattice.total()); ++site)
      if ((owner ? owner(site) : 0) == rank) sites.push_back(site);
    rows = field::Rows::number(comm, 2, rank, 0, static_cast<Index>(sites.size())); // other rows come first
    pd::StencilOptions options;
    options.dx = lattice.dx;
    options.horizon = horizon_ratio * lattice.dx;
    options.thickness = 0.5;
    options.elastic = {3.0, 1.0 / 3.0, law::Plane::stress, 0.5};
    parts.push_back(std::make_unique<pd::LatticePart<2>>(rows, lattice, pd::make_stencil<2>(options), std::move(sites),
                                                         rows.first_particle(), pd::SurfaceCorrection<2>()));
  }

  const pd::LatticePart<2>& part() const { return *parts[0]; }
  Vector<2> point(std::size_t k) const { return part().lattice().point(part().lattice().site(part().sites()[k])); }

  /// Cuts the bonds that the cracks part.
  void cut(const crack::CrackSet& cracks) const
  {
    if (part().sites().empty()) return;
    const pd::Stencil<2>& stencil = part().stencil();
    pd::WindowSites<2> sites{part().lattice(), {}, {}};
    for (std::size_t d = 0; d < 2; ++d) {
      Index lower = std::numeric_limits<Index>::max(), upper = 0;
      for (const Index site : part().sites()) {
        lower = std::min(lower, part().lattice().site(site)[d]);
        upper = std::max(upper, part().lattice().site(site)[d]);
      }
      sites.lower[d] = lower - stencil.reach;
      sites.extent[d] = upper - lower + 1 + 2 * stencil.reach;
    }
    sites.extent[0] = (sites.extent[0] + 16 + 7) / 8 * 8;
    const auto window = part().window();
    const auto words = part().view(window).words;
    pd::cut_bonds<2>(cracks, sites, stencil, part().force_runs(),
                     {const_cast<std::uint64_t*>(words[0]), const_cast<std::uint64_t*>(words[1])});
  }

  /// The field at the owned rows; 1e6 at rows that are no particles.
  std::vector<double> displacement(const std::function<Vector<2>(const Vector<2>&)>& field) const
  {
    std::vector<double> u(2 * static_cast<std::size_t>(rows.first_particle()), 1e6);
    for (std::size_t k = 0; k < part().sites().size(); ++k) {
      const Vector<2> value = field(point(k));
      u.insert(u.end(), {value.x(), value.y()});
    }
    return u;
  }

  /// Strain energy density per owned row, bond by bond [J/m^3]. Collective.
  std::vector<double> density(std::span<const double> u) const
  {
    auto window = part().window();
    part().load(u, window);
    std::vector<double> w(static_cast<std::size_t>(rows.owned()), 0.0);
    for (Index k = 0; k < static_cast<Index>(part().sites().size()); ++k)
      part().for_each_bond(k, [&](std::size_t h, int sign, const Site<2>&, double weight) {
        const pd::Arm<2>& arm = part().stencil().half[h];
        const auto bond = law::linear_state<2>(sign * arm.xi, arm.length, part().relative(window, k, h, sign));
        w[static_cast<std::size_t>(part().first_row() + k)] +=
            0.5 * law::bond_energy(weight * arm.kappa, arm.length, bond.stretch) / part().stencil().volume();
      });
    return w;
  }
};
} // namespace pdx::test
