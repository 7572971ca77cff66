#pragma once
#include "pdx/field/force_loss.hpp"
#include "pdx/field/free_strain.hpp"
#include "pdx/field/rows.hpp"
#include "pdx/geom/line_pieces.hpp"
#include "pdx/law/regions.hpp"
#include "pdx/law/scatter.hpp"
#include "pdx/pd/breaker.hpp"
#include "pdx/pd/damage.hpp"
#include "pdx/pd/site_directory.hpp"
#include "pdx/pd/stencil.hpp"
#include "pdx/pd/surface.hpp"

#include <functional>
#include <memory>

namespace pdx::pd {
/// Sites that kernels may read past the last particle of a row.
inline constexpr Index kWindowPadding = 16;

/// A bond that broke: half arm `arm` of the site with window index `at`, at relative displacement eta = u_j - u_i [m].
template <int Dim> struct LostBond {
  std::ptrdiff_t at;
  std::uint32_t arm;
  Vector<Dim> eta;
};

/// One rank's part of one patch: its particles as runs along x in a dense, padded window of the lattice, the halo
/// around them, and the bond words. Windows are structure-of-arrays so that the bond kernels need no index lists.
/// Bonds to particles of other ranks are kept on either side, and change here and there by the same arithmetic. Bonds
/// are counted by the rank of their lower end.
template <int Dim> class LatticePart {
public:
  /// @param where   sites of the whole patch, by whose place they are numbered
  /// @param sites   owned site numbers, ascending; their rows follow each other from local row `first_row`
  /// @param correction  of bonds near free surfaces and in regions of other materials; empty: none. Collective.
  /// @param regions  of other densities and toughness; null: all is of one
  LatticePart(const field::Rows& rows, geom::ActiveLattice<Dim> where, Stencil<Dim> stencil, std::vector<Index> sites,
              Index first_row, SurfaceCorrection<Dim> correction,
              std::shared_ptr<const law::Regions> regions = nullptr);

  const geom::ActiveLattice<Dim>& where() const { return where_; }
  const geom::Lattice<Dim>& lattice() const { return where_.lattice; }
  const geom::SiteSet<Dim>& active() const { return where_.active; } ///< sites of the whole patch
  Site<Dim> site(Index number) const { return where_.active.site(number); }
  Index number(const Site<Dim>& site) const
  {
    return static_cast<Index>(where_.active.place(site));
  } ///< of an active site
  /// Has the patch a bond along half arm `arm` from the site at first? Both ends are particles, and what is between
  /// them is of the patch too.
  bool begins(const Site<Dim>& site, std::size_t arm) const
  {
    return geom::runs_inside<Dim>(where_.active, site, lines_[arm]);
  }
  /// Are all sites up to a bond's reach away particles?
  bool deep(const Site<Dim>& site) const { return deep_.has(site); }
  const Stencil<Dim>& stencil() const { return stencil_; }
  std::span<const Index> sites() const { return sites_; } ///< owned site numbers
  Index first_row() const { return first_row_; }          ///< local row of sites()[0]
  const SiteDirectory& directory() const { return directory_; }
  /// The same particles have other rows from now on, on ranks that own what they owned. Nothing else changes. For what
  /// has not been numbered for assembly. Collective.
  /// @param first_row local row of sites()[0]   @param correction as given at first, on what stands now
  void move_rows(const field::Rows& rows, Index first_row, SurfaceCorrection<Dim> correction);
  /// Local row of an owned site, -1 if another rank (or none) has it; after `number_halo` halo sites have theirs too.
  Index row(const Site<Dim>& site) const;

  MPI_Comm comm() const { return rows_.comm; }

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
  /// Fetches the halo and runs `meanwhile` while it travels. Collective.
  /// @return rows of Dim in the order of `halo_at`, good until the next exchange; nothing on a single rank
  std::span<const double> exchange(std::span<const double> owned, const std::function<void()>& meanwhile) const;
  double waited() const { return waited_; }                            ///< for halos to come [s]
  std::span<const std::ptrdiff_t> halo_at() const { return halo_at_; } ///< window index per halo site
  const Site<Dim>& extent() const { return extent_; }                  ///< sites of the window, padding included
  std::span<const Run> particle_runs() const { return segments_; }     ///< owned particles; their kind says nothing

  /// Displacement of a neighbour relative to particle k, u_j - u_i [m], from a loaded window.
  Vector<Dim> relative(const Window& window, Index k, std::size_t arm, int sign) const;
  BondView<Dim> view(const Window& window) const;
  /// From now on sites have this free strain, halo included.
  void swell(const field::FreeStrain& strain);
  /// Of the bond along half arm `arm` from particle k [-].
  double free_strain(Index k, std::size_t arm, int sign) const;
  std::span<const Run> force_runs() const { return fresh(force_runs_); } ///< whole only where no bond is missing
  /// whole where no bond was lost; neighbours that never were count as u = 0
  std::span<const Run> linear_runs() const { return fresh(linear_runs_); }
  /// How bonds near free surfaces are corrected, those that leave the patch too; may be empty.
  const SurfaceCorrection<Dim>& correction() const { return correction_; }
  /// The factors of bonds that start in a box of sites; known ones are given away.
  BondFactors<Dim> take_factors(const Site<Dim>& lower, const Site<Dim>& extent);
  void forget_factors() { factors_known_ = {}; }

  /// Bonds with an end in one of the boxes [m] never break; cracks still cut them. In 3-D boxes reach through.
  void protect(std::span<const geom::Box<2>> boxes);
  /// Takes out the bonds that a crack parts, the precrack. To be called before anything breaks.
  /// @return how many of them this rank counts
  std::int64_t cut(const crack::CrackSet& cracks);
  /// Breaks all bonds that are overstretched at a loaded window; `rule.no_fail` is replaced by what `protect` said.
  Broken break_bonds(const Window& loaded, BreakRule rule);
  using LostBonds = std::span<const LostBond<Dim>>;
  /// Takes out bonds that another layout of the same part found overstretched, in time that grows with their number.
  /// @param losses if not null, their forces on owned rows are appended
  Broken lose(LostBonds lost, Kinematics kinematics, field::ForceLosses* losses = nullptr);
  /// Of owned particle k, by volume of one as thick as the stencil [kg/m^3].
  double density(Index k) const;
  /// Does the critical stretch of bonds differ from one to another?
  bool stretches_vary() const { return has_stretches_by_region() || !scatter_.empty(); }
  /// Spreads the stretch at which bonds break. Before anybody watches them.
  /// @param first the lattice's site (0, 0) in that of the body
  void scatter(const law::Scatter& scatter, const std::array<std::int64_t, 2>& first);
  /// What a site, of this patch or not, adds to the factor 1 on the critical stretch of its bonds [-].
  double share(const Site<Dim>& site) const;
  /// Critical stretch of the bond along half arm `arm` of the site with window index `at` over that of the patch [-].
  /// The bond is there, and of a particle of this rank.
  double stretch_factor(std::ptrdiff_t at, std::size_t arm) const
  {
    const auto i = static_cast<std::size_t>(at), j = static_cast<std::size_t>(at + arms_[arm].jump);
    return (has_stretches_by_region() ? regions_->stretch(region_[i], region_[j]) : 1.0) *
           (scatter_.empty() ? 1.0 : 1.0 + (scatter_[i] + scatter_[j]));
  }
  bool protects_any() const { return !no_fail_.empty(); }
  /// True if `protect` keeps the bond along half arm `arm` of the site with window index `at`.
  bool protects(std::ptrdiff_t at, std::size_t arm) const
  {
    return !no_fail_.empty() &&
           (no_fail_[static_cast<std::size_t>(at)] || no_fail_[static_cast<std::size_t>(at + arms_[arm].jump)]);
  }
  /// Appends s/s0 of what `break_bonds` would break, of the bonds that this rank counts.
  void overstretched(const Window& loaded, BreakRule rule, std::vector<double>& ratios) const;
  /// Remembers the bonds; `restore` goes back to those remembered last.
  void save();
  void restore();

  /// Sites of other ranks whose words, besides those of `sites`, say which bonds owned particles have.
  std::vector<Index> halo_sites() const;
  /// Bonds that start at owned particle k and are gone, those that a crack cut included, bit h for half arm h.
  std::array<std::uint64_t, 2> gone_of(Index k) const;
  std::vector<std::uint64_t> gone() const; ///< of all owned particles, two words each
  /// Numbers of the owned particles that lost bonds, ascending, and what `gone_of` has of each.
  std::vector<std::pair<Index, std::array<std::uint64_t, 2>>> torn() const;
  /// Breaks the bonds that these words have, two words (`gone_of`) for each of `sites`, then of
  /// `halo_sites`. After `cut`.
  void set_gone(std::span<const std::uint64_t> words);
  /// A bond by its lower end, whatever holds that.
  struct BondAt {
    Site<Dim> lower;
    std::size_t arm; ///< half arm
  };
  /// Breaks those of these bonds that owned particles have. After `cut`.
  void set_gone(std::span<const BondAt> bonds);
  /// Intact bonds that start at owned particle k, bit h for half arm h.
  std::array<std::uint64_t, 2> words_of(Index k) const;
  std::int64_t bonds() const; ///< intact ones that this rank counts
  /// Appends local rows of particles that lost bonds and have (almost) no stiffness left in some direction.
  void weak_rows(std::vector<Index>& rows) const;
  /// @param volumes one entry per owned row
  void add_bonded_volume(std::span<BondedVolume> volumes) const;
  /// Local rows of the particles that lost bonds to load are appended, ascending.
  void add_thinned(std::vector<Index>& rows) const;
  void add_bonded_volume(Index row, BondedVolume& volume) const; ///< of a row of this part; else nothing

private:
  using Words = std::array<std::vector<std::uint64_t>, 2>;
  enum Trait : std::uint8_t {
    kOwned = 1,
    kPlain = 2,    ///< all its bonds have surface factor 1
    kComplete = 4, ///< it had all bonds of a full family at first
    kLost = 8      ///< it lost a bond since
  };
  bool has_stretches_by_region() const { return regions_ && !regions_->one_stretch(); }
  std::ptrdiff_t at(const Site<Dim>& site) const;
  bool in_window(const Site<Dim>& site) const;
  bool has_bond(std::ptrdiff_t at, std::size_t arm) const;
  bool is_own(std::ptrdiff_t at, std::size_t arm) const;
  /// Calls visit(k, site) for each owned site, in order.
  template <class Visit> void for_each_own(Visit&& visit) const;
  void go_on(Site<Dim>& site, Index count) const;
  std::vector<std::uint8_t> surrounded(std::vector<std::uint8_t> sites) const;
  void place_window();
  void write_bond_words();
  void write_classes();
  void find_regions();
  BreakRule completed(BreakRule rule) const;
  void collect_halo();
  void connect_halo();
  void find_traits();
  std::uint8_t traits(std::ptrdiff_t at) const;
  void make_runs() const;
  const std::vector<Run>& fresh(const std::vector<Run>& runs) const
  {
    if (runs_stale_) make_runs();
    return runs;
  }
  Site<Dim> site_at(std::ptrdiff_t at) const;
  std::size_t planes() const { return (arms_.size() + 63) / 64; }
  BondWords writable(Words& words) const { return {words[0].data(), words[1].data()}; }
  template <class Visit> static void for_each_loss(const Words& before, const Words& after, Visit&& visit);
  void note_losses();
  void note_loss(std::ptrdiff_t i, std::size_t h);
  void note_force(const LostBond<Dim>& bond, Kinematics kinematics, field::ForceLosses& losses) const;
  double surface_factor(std::ptrdiff_t lower, std::size_t arm) const;
  double stretch(const Window& loaded, std::ptrdiff_t i, std::size_t h, Kinematics kinematics) const;
  double stretch(const LostBond<Dim>& bond, Kinematics kinematics) const;
  double free_strain(std::ptrdiff_t lower, std::size_t arm) const
  {
    return swelling_.empty() ? 0.0
                             : swelling_[static_cast<std::size_t>(lower)] +
                                   swelling_[static_cast<std::size_t>(lower + arms_[arm].jump)];
  }
  double energy_of(std::ptrdiff_t i, std::size_t h, double stretch) const;
  const std::vector<double>& bonded_volume_now() const;
  void forget_volume() const;
  void remember_volume();

  field::Rows rows_;
  geom::ActiveLattice<Dim> where_;
  Stencil<Dim> stencil_;
  std::vector<Index> sites_;
  Index first_row_;
  geom::SiteSet<Dim> deep_;                              ///< sites from which no bond leaves the patch
  std::vector<std::vector<geom::LinePiece<Dim>>> lines_; // per half arm
  SiteDirectory directory_;

  Site<Dim> lower_{}, extent_{}; // window: first site, sites per direction (padding included)
  std::array<std::ptrdiff_t, Dim> stride_{};
  std::ptrdiff_t window_size_ = 0;
  std::vector<HalfArm<Dim>> arms_;
  Words words_;
  mutable Words other_words_;                  // those before a change, or what they would be after it
  std::vector<std::uint8_t> traits_, no_fail_; // per window site; no_fail_ empty: none
  struct {
    Words words;
    std::vector<std::uint8_t> traits;
    bool current = false; // nothing has changed since
  } saved_;
  std::vector<double> swelling_;                    // per window site, see BondView; empty: nothing swells
  std::vector<double> whole_volume_, start_volume_; // per owned particle; empty until bonds change [m^3]
  mutable std::vector<double> now_volume_;          // likewise, but of particles that lost bonds since; empty: unknown
  mutable std::vector<std::ptrdiff_t> thinned_;     // window indices of those, where now_volume_ is known
  SurfaceCorrection<Dim> correction_;
  std::shared_ptr<const law::Regions> regions_;
  std::vector<std::uint8_t> region_; // per window site; empty: none of them matters here
  std::vector<double> scatter_;      // per window site, see BreakRule::shares; empty: none
  law::Scatter spread_;
  std::array<std::int64_t, 2> first_{}; // the site (0, 0) in the lattice of the body
  std::vector<std::uint16_t> classes_;  // per window site; empty: no bond of this rank has a surface factor
  std::vector<double> factors_;         // per class and half arm [-]
  std::vector<Index> local_rows_;       // per window site: local row or -1
  mutable std::vector<Run> force_runs_, linear_runs_;
  mutable bool runs_stale_ = true; // made when they are asked for
  std::vector<Run> segments_;
  std::vector<PetscInt> halo_rows_, halo_rows_given_; // now; as the directory was given them
  std::vector<std::ptrdiff_t> halo_at_;
  SfHandle halo_sf_; // from particles by their places in sites_
  mutable std::vector<double> halo_buffer_;
  mutable double waited_ = 0.0;
  BondFactors<Dim> factors_known_; ///< in the window, until somebody takes them
};

template <int Dim> std::ptrdiff_t LatticePart<Dim>::at(const Site<Dim>& site) const
{
  std::ptrdiff_t position = 0;
  for (std::size_t d = 0; d < Dim; ++d) position += (site[d] - lower_[d]) * stride_[d];
  return position;
}

template <int Dim> bool LatticePart<Dim>::has_bond(std::ptrdiff_t at, std::size_t arm) const
{
  return words_[arm / 64][static_cast<std::size_t>(at)] >> (arm % 64) & 1u;
}

template <int Dim> double LatticePart<Dim>::surface_factor(std::ptrdiff_t lower, std::size_t arm) const
{
  return classes_.empty() ? 1.0 : factors_[classes_[static_cast<std::size_t>(lower)] * arms_.size() + arm];
}

template <int Dim> template <class Visit> void LatticePart<Dim>::for_each_own(Visit&& visit) const
{
  Site<Dim> site{};
  Index end = 0; // of the run that holds the site before
  for (std::size_t k = 0; k < sites_.size(); ++k) {
    if (k > 0 && sites_[k] == sites_[k - 1] + 1 && site[0] + 1 < end)
      ++site[0];
    else {
      site = where_.active.site(sites_[k]);
      end = where_.active.end_of_run(site);
    }
    visit(k, std::as_const(site));
  }
}

template <int Dim> template <class Visit> void LatticePart<Dim>::for_each_bond(Index k, Visit&& visit) const
{
  const Site<Dim> site = where_.active.site(sites_[static_cast<std::size_t>(k)]);
  const std::ptrdiff_t i = at(site);
  for (std::size_t h = 0; h < arms_.size(); ++h)
    for (const int sign : {+1, -1}) {
      const std::ptrdiff_t j = i + sign * arms_[h].jump;
      if (!has_bond(sign > 0 ? i : j, h)) continue;
      Site<Dim> other = site;
      for (std::size_t d = 0; d < Dim; ++d) other[d] += sign * stencil_.half[h].step[d];
      visit(h, sign, other, surface_factor(sign > 0 ? i : j, h));
    }
}
} // namespace pdx::pd
