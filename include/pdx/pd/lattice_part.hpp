#pragma once
#include "pdx/field/rows.hpp"
#include "pdx/geom/lattice.hpp"
#include "pdx/pd/bond_kernel.hpp"
#include "pdx/pd/site_directory.hpp"
#include "pdx/pd/stencil.hpp"

#include <functional>
#include <memory>

namespace pdx::pd {
/// True for a site, inside or outside the lattice, where the body has material that counts to a bond family.
template <int Dim> using Exists = std::function<bool(const Site<Dim>&)>;

/// Largest step of a family member in any direction, bonds or not: the width of a complete neighbourhood in sites.
template <int Dim> int family_reach(const Stencil<Dim>& stencil);
/// Family volume of a site over that of a complete family [-]; 1 inside, less near a free surface.
template <int Dim> double family_share(const Stencil<Dim>& stencil, const Site<Dim>& site, const Exists<Dim>& exists);

/// One rank's part of one patch: its particles as runs along x in a dense, padded window of the lattice, the halo
/// around them, and the bond words. Windows are structure-of-arrays so that the bond kernels need no index lists.
template <int Dim> class LatticePart {
public:
  /// @param sites   owned site numbers, ascending; their rows follow each other from local row `first_row`
  /// @param exists  for the surface correction by the volume method; empty = no correction. Collective.
  LatticePart(const field::Rows& rows, geom::Lattice<Dim> lattice, Stencil<Dim> stencil, std::vector<Index> sites,
              Index first_row, const Exists<Dim>& exists);

  const geom::Lattice<Dim>& lattice() const { return lattice_; }
  const Stencil<Dim>& stencil() const { return stencil_; }
  std::span<const Index> sites() const { return sites_; } ///< owned site numbers
  Index first_row() const { return first_row_; }          ///< local row of sites()[0]
  const SiteDirectory& directory() const { return directory_; }
  /// Local row of an owned site, -1 if another rank (or none) has it; after `number_halo` halo sites have theirs too.
  Index row(const Site<Dim>& site) const;

  /// Global rows of the halo sites, in halo order.
  std::span<const PetscInt> halo_rows() const { return halo_rows_; }
  /// Gives halo sites their local rows in `halo`, which must hold `halo_rows()`; for assembly.
  void number_halo(const field::RowHalo& halo);
  /// Calls visit(arm number, +1 or -1, neighbour site, weight) for each bond that particle k has.
  template <class Visit> void for_each_bond(Index k, Visit&& visit) const;

  using Window = std::array<std::vector<double>, Dim>;
  Window window() const; ///< zero displacement window
  /// Fills a window from owned rows (interleaved, from local row 0) and fetches the halo. Collective.
  void load(std::span<const double> owned, Window& window) const;

  /// Displacement of a neighbour relative to particle k, u_j - u_i [m], from a loaded window.
  Vector<Dim> relative(const Window& window, Index k, std::size_t arm, int sign) const;
  BondView<Dim> view(const Window& window) const;
  std::span<const Run> force_runs() const { return force_runs_; }   ///< whole only where no bond is missing
  std::span<const Run> linear_runs() const { return linear_runs_; } ///< whole where absent neighbours count as u = 0
  /// True if some bond of the patch, on whatever rank, has a surface correction factor.
  bool corrected() const { return corrected_; }

private:
  std::ptrdiff_t at(const Site<Dim>& site) const;
  bool in_window(const Site<Dim>& site) const;
  bool has_bond(std::ptrdiff_t at, std::size_t arm) const;
  void place_window();
  void write_bond_words();
  void write_shares(const Exists<Dim>& exists);
  void collect_halo();
  void make_runs();

  field::Rows rows_;
  geom::Lattice<Dim> lattice_;
  Stencil<Dim> stencil_;
  std::vector<Index> sites_;
  Index first_row_;
  SiteDirectory directory_;

  Site<Dim> lower_{}, extent_{}; // window: first site, sites per direction (padding included)
  std::array<std::ptrdiff_t, Dim> stride_{};
  std::ptrdiff_t window_size_ = 0;
  std::vector<HalfArm<Dim>> arms_;
  std::vector<std::uint64_t> words_[2];
  std::vector<double> share_;
  bool corrected_ = false;        // alike on every rank, also on those without particles
  std::vector<Index> local_rows_; // per window site: local row or -1
  std::vector<Run> force_runs_, linear_runs_, segments_;
  std::vector<PetscInt> halo_rows_;
  std::vector<std::ptrdiff_t> halo_at_;
  SfHandle halo_sf_;
  mutable std::vector<double> halo_buffer_;
};

template <int Dim> template <class Visit> void LatticePart<Dim>::for_each_bond(Index k, Visit&& visit) const
{
  const Site<Dim> site = lattice_.site(sites_[static_cast<std::size_t>(k)]);
  const std::ptrdiff_t i = at(site);
  for (std::size_t h = 0; h < arms_.size(); ++h)
    for (const int sign : {+1, -1}) {
      const std::ptrdiff_t j = i + sign * arms_[h].jump;
      if (!has_bond(sign > 0 ? i : j, h)) continue;
      Site<Dim> other = site;
      for (std::size_t d = 0; d < Dim; ++d) other[d] += sign * stencil_.half[h].step[d];
      const double weight =
          share_.empty() ? 1.0 : 2.0 / (share_[static_cast<std::size_t>(i)] + share_[static_cast<std::size_t>(j)]);
      visit(h, sign, other, weight);
    }
}
} // namespace pdx::pd
