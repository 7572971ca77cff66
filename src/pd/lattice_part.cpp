#include "pdx/pd/lattice_part.hpp"

#include "pdx/base/block_type.hpp"
#include "pdx/base/events.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

namespace pdx::pd {
namespace {
template <int Dim> Site<Dim> shifted(Site<Dim> site, const Site<Dim>& step, Index times)
{
  for (std::size_t d = 0; d < Dim; ++d) site[d] += times * step[d];
  return site;
}
} // namespace

template <int Dim>
LatticePart<Dim>::LatticePart(const field::Rows& rows, geom::ActiveLattice<Dim> where, Stencil<Dim> stencil,
                              std::vector<Index> sites, Index first_row, SurfaceCorrection<Dim> correction,
                              std::shared_ptr<const law::Regions> regions)
    : rows_(rows), where_(std::move(where)), stencil_(std::move(stencil)), sites_(std::move(sites)),
      first_row_(first_row), deep_(where_.active.eroded(stencil_.reach)),
      directory_(rows.comm, static_cast<Index>(where_.active.size()), sites_, rows.first + first_row),
      correction_(std::move(correction)), regions_(std::move(regions))
{
  require_bond_words(stencil_);
  for (const Arm<Dim>& arm : stencil_.half) lines_.push_back(geom::pieces_of_line<Dim>(arm.step));
  place_window();
  find_regions();
  write_bond_words();
  if (correction_) write_classes();
  collect_halo();
  find_traits();
}

template <int Dim> void LatticePart<Dim>::place_window()
{
  Site<Dim> upper{};
  lower_.fill(std::numeric_limits<Index>::max());
  upper.fill(std::numeric_limits<Index>::lowest());
  for_each_own([&](std::size_t, const Site<Dim>& site) {
    for (std::size_t d = 0; d < Dim; ++d) {
      lower_[d] = std::min(lower_[d], site[d]);
      upper[d] = std::max(upper[d], site[d]);
    }
  });
  window_size_ = sites_.empty() ? 0 : 1;
  for (std::size_t d = 0; d < Dim; ++d) {
    lower_[d] -= stencil_.reach;
    extent_[d] = sites_.empty() ? 0 : upper[d] - lower_[d] + 1 + stencil_.reach;
    if (d == 0 && !sites_.empty()) extent_[0] = (extent_[0] + kWindowPadding + 7) / 8 * 8;
    stride_[d] = window_size_;
    window_size_ *= extent_[d];
  }
  if (window_size_) window_size_ += kWindowPadding;
  for (const Arm<Dim>& arm : stencil_.half) {
    HalfArm<Dim> half{0, {}, arm.length, arm.kappa};
    for (std::size_t d = 0; d < Dim; ++d) {
      half.jump += arm.step[d] * stride_[d];
      half.xi[d] = arm.xi[static_cast<Eigen::Index>(d)];
    }
    arms_.push_back(half);
  }
  local_rows_.assign(static_cast<std::size_t>(window_size_), -1);
  for_each_own([&](std::size_t k, const Site<Dim>& site) {
    local_rows_[static_cast<std::size_t>(at(site))] = first_row_ + static_cast<Index>(k);
  });
}

/// In space regions reach through the thickness.
template <int Dim> void LatticePart<Dim>::find_regions()
{
  if (regions_ && regions_->one_elastic() && regions_->one_stretch()) regions_.reset();
  if (!regions_) return;
  region_.assign(static_cast<std::size_t>(window_size_), 0);
  Site<Dim> site = lower_;
  for (std::ptrdiff_t k = 0; k + kWindowPadding < window_size_; ++k, go_on(site, 1))
    region_[static_cast<std::size_t>(k)] = regions_->at(where_.lattice.point(site).template head<2>());
}

template <int Dim> double LatticePart<Dim>::density(Index k) const
{
  if (!regions_) return stencil_.density;
  const std::ptrdiff_t i = at(where_.active.site(sites_[static_cast<std::size_t>(k)]));
  const law::Elastic& own = regions_->elastic(region_[static_cast<std::size_t>(i)]);
  return own.density * (Dim == 2 ? own.thickness / stencil_.thickness : 1.0);
}

template <int Dim> double LatticePart<Dim>::share(const Site<Dim>& site) const
{
  if (!spread_.any()) return 0.0;
  std::array<std::int64_t, Dim> number;
  for (std::size_t d = 0; d < Dim; ++d) number[d] = site[d] + (d < 2 ? first_[d] : 0);
  return spread_.share(number);
}

template <int Dim> void LatticePart<Dim>::scatter(const law::Scatter& scatter, const std::array<std::int64_t, 2>& first)
{
  spread_ = scatter;
  first_ = first;
  scatter_.clear();
  if (!scatter.any()) return;
  scatter_.assign(static_cast<std::size_t>(window_size_), 0.0);
  Site<Dim> site = lower_;
  for (std::ptrdiff_t k = 0; k + kWindowPadding < window_size_; ++k, go_on(site, 1))
    scatter_[static_cast<std::size_t>(k)] = share(site);
}

/// A rule with what only this part knows.
template <int Dim> BreakRule LatticePart<Dim>::completed(BreakRule rule) const
{
  rule.no_fail = no_fail_.empty() ? nullptr : no_fail_.data();
  rule.shares = scatter_.empty() ? nullptr : scatter_.data();
  rule.least_share = spread_.least();
  if (!has_stretches_by_region()) return rule;
  rule.regions = regions_.get();
  rule.region = region_.data();
  return rule;
}

template <int Dim> bool LatticePart<Dim>::in_window(const Site<Dim>& site) const
{
  for (std::size_t d = 0; d < Dim; ++d)
    if (site[d] < lower_[d] || site[d] >= lower_[d] + extent_[d]) return false;
  return true;
}

template <int Dim> Index LatticePart<Dim>::row(const Site<Dim>& site) const
{
  return in_window(site) ? local_rows_[static_cast<std::size_t>(at(site))] : -1;
}

/// A bond belongs to its lower end: bit h of a site says that the bond along half arm h is there and intact. Bonds of
/// owned particles start at owned sites or within reach of them, so only those words are written.
template <int Dim> void LatticePart<Dim>::write_bond_words()
{
  for (std::size_t p = 0; p < planes(); ++p) words_[p].assign(static_cast<std::size_t>(window_size_), 0);
  std::array<std::uint64_t, 2> all{0, 0};
  for (std::size_t h = 0; h < arms_.size(); ++h) all[h / 64] |= std::uint64_t{1} << (h % 64);
  Site<Dim> site = lower_;
  for (std::ptrdiff_t k = 0; k + kWindowPadding < window_size_;) {
    Index count = 1;
    if (deep_.has(site)) {
      count = std::min(deep_.end_of_run(site), lower_[0] + extent_[0]) - site[0];
      for (std::size_t p = 0; p < planes(); ++p) std::fill_n(words_[p].begin() + k, count, all[p]);
    } else if (where_.active.has(site))
      for (std::size_t h = 0; h < arms_.size(); ++h)
        if (begins(site, h)) words_[h / 64][static_cast<std::size_t>(k)] |= std::uint64_t{1} << (h % 64);
    k += count;
    go_on(site, count);
  }
}

/// To the site so many places on in the window, at most the next row's first.
template <int Dim> void LatticePart<Dim>::go_on(Site<Dim>& site, Index count) const
{
  site[0] += count;
  for (std::size_t d = 0; d + 1 < Dim && site[d] >= lower_[d] + extent_[d]; ++d) {
    site[d] = lower_[d];
    ++site[d + 1];
  }
}

/// 1 for the sites of the window that have 1 up to a bond's reach away in every direction.
template <int Dim> std::vector<std::uint8_t> LatticePart<Dim>::surrounded(std::vector<std::uint8_t> sites) const
{
  const auto size = static_cast<std::ptrdiff_t>(sites.size());
  for (std::size_t d = 0; d < Dim; ++d) {
    const std::vector<std::uint8_t> before = sites;
    for (Index k = 1; k <= stencil_.reach; ++k) {
      const std::ptrdiff_t shift = std::min(size, k * stride_[d]);
      for (std::ptrdiff_t i = 0; i < shift; ++i) sites[static_cast<std::size_t>(i)] = 0;
      for (std::ptrdiff_t i = size - shift; i < size; ++i) sites[static_cast<std::size_t>(i)] = 0;
      std::uint8_t* const of = sites.data();
      for (std::ptrdiff_t i = shift; i < size - shift; ++i)
        of[i] = static_cast<std::uint8_t>(of[i] & before[static_cast<std::size_t>(i - shift)] &
                                          before[static_cast<std::size_t>(i + shift)]);
    }
  }
  return sites;
}

/// Sites whose bonds have the same factors are of one class; class 0 has the factor 1 throughout.
template <int Dim> void LatticePart<Dim>::write_classes()
{
  factors_known_ = correction_({where_.lattice, lower_, extent_, &where_.active});
  const BondFactors<Dim>& factors = factors_known_;
  std::map<std::vector<double>, std::uint16_t> known{{std::vector<double>(arms_.size(), 1.0), 0}};
  classes_.assign(static_cast<std::size_t>(window_size_), 0);
  std::vector<double> here(arms_.size());
  Site<Dim> site = lower_;
  for (std::ptrdiff_t k = 0; k + kWindowPadding < window_size_;) {
    const Index plain = std::min(factors.end_of_plain(site), lower_[0] + extent_[0]) - site[0];
    if (plain == 0 && where_.active.has(site)) {
      for (std::size_t h = 0; h < arms_.size(); ++h) here[h] = has_bond(k, h) ? factors.of(site, h) : 1.0;
      const auto number = static_cast<std::uint16_t>(known.size());
      if (known.size() > std::numeric_limits<std::uint16_t>::max())
        throw std::logic_error("more than 65536 kinds of sites at surfaces and at borders of regions: give simpler "
                               "-region_... or more ranks");
      classes_[static_cast<std::size_t>(k)] = known.try_emplace(here, number).first->second;
    }
    k += std::max(plain, 1);
    go_on(site, std::max(plain, 1));
  }
  if (known.size() == 1) return classes_.clear();
  factors_.resize(known.size() * arms_.size());
  for (const auto& [values, number] : known) std::ranges::copy(values, factors_.begin() + number * arms_.size());
}

template <int Dim> BondFactors<Dim> LatticePart<Dim>::take_factors(const Site<Dim>& lower, const Site<Dim>& extent)
{
  if (!correction_) return {};
  bool known = static_cast<bool>(factors_known_.of);
  for (std::size_t d = 0; d < Dim; ++d)
    known = known && lower[d] >= lower_[d] && lower[d] + extent[d] <= lower_[d] + extent_[d];
  if (known) return std::exchange(factors_known_, {});
  return correction_({where_.lattice, lower, extent, &where_.active});
}

template <int Dim> std::vector<std::pair<Index, std::array<std::uint64_t, 2>>> LatticePart<Dim>::torn() const
{
  std::vector<std::pair<Index, std::array<std::uint64_t, 2>>> found;
  for (const Run& run : segments_)
    for (Index k = 0; k < run.length; ++k)
      if (const Index number = run.row - first_row_ + k; traits_[static_cast<std::size_t>(run.at + k)] & kLost)
        found.emplace_back(number, gone_of(number));
  return found;
}

template <int Dim> std::vector<std::uint64_t> LatticePart<Dim>::gone() const
{
  std::vector<std::uint64_t> words(2 * sites_.size(), 0);
  for (const auto& [number, of] : torn()) std::ranges::copy(of, words.begin() + 2 * std::ptrdiff_t{number});
  return words;
}

template <int Dim> void LatticePart<Dim>::collect_halo()
{
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(window_size_), 0), own(seen);
  for (std::size_t i = 0; i < own.size(); ++i) own[i] = local_rows_[i] >= 0;
  own = surrounded(std::move(own));
  std::vector<Index> wanted;
  for_each_own([&](std::size_t, const Site<Dim>& site) {
    const std::ptrdiff_t i = at(site);
    if (own[static_cast<std::size_t>(i)]) return;
    for (std::size_t h = 0; h < arms_.size(); ++h)
      for (const Index sign : {1, -1}) {
        const std::ptrdiff_t j = i + sign * arms_[h].jump;
        if (local_rows_[static_cast<std::size_t>(j)] >= 0 || seen[static_cast<std::size_t>(j)]) continue;
        seen[static_cast<std::size_t>(j)] = 1;
        const Site<Dim> other = shifted<Dim>(site, stencil_.half[h].step, sign);
        if (!where_.active.has(other)) continue;
        wanted.push_back(number(other));
        halo_at_.push_back(j);
      }
  });
  halo_rows_ = halo_rows_given_ = directory_.rows(wanted);
  halo_buffer_.resize(halo_rows_.size() * Dim);
  connect_halo();
}

/// Particles count from the first of their rank, so that the exchange outlives their rows.
template <int Dim> void LatticePart<Dim>::connect_halo()
{
  int ranks = 1;
  MPI_Comm_size(rows_.comm, &ranks);
  std::vector<Index> first(static_cast<std::size_t>(ranks));
  MPI_Allgather(&first_row_, 1, MPI_INT, first.data(), 1, MPI_INT, rows_.comm);
  PetscLayout layout = nullptr;
  PDX_CALL(PetscLayoutCreateFromSizes(rows_.comm, rows_.owned(), rows_.total, 1, &layout));
  std::vector<PetscSFNode> particles;
  for (const PetscInt row : halo_rows_) {
    PetscMPIInt rank = 0;
    PetscInt local = 0;
    PDX_CALL(PetscLayoutFindOwnerIndex(layout, row, &rank, &local));
    particles.push_back({rank, local - first[static_cast<std::size_t>(rank)]});
  }
  PDX_CALL(PetscLayoutDestroy(&layout));
  PDX_CALL(PetscSFCreate(rows_.comm, halo_sf_.out()));
  PDX_CALL(PetscSFSetGraph(halo_sf_.get(), static_cast<PetscInt>(sites_.size()),
                           static_cast<PetscInt>(particles.size()), nullptr, PETSC_COPY_VALUES, particles.data(),
                           PETSC_COPY_VALUES));
  PDX_CALL(PetscSFSetUp(halo_sf_.get()));
}

template <int Dim>
void LatticePart<Dim>::move_rows(const field::Rows& rows, Index first_row, SurfaceCorrection<Dim> correction)
{
  const Index by = first_row - first_row_;
  rows_ = rows;
  first_row_ = first_row;
  correction_ = std::move(correction);
  directory_.move(rows.first + first_row);
  for (std::size_t k = 0; k < halo_rows_.size(); ++k) halo_rows_[k] = directory_.moved(halo_rows_given_[k]);
  if (by == 0) return;
  for (Index& row : local_rows_)
    if (row >= 0) row += by;
  for (Run& run : segments_) run.row += by;
  runs_stale_ = true;
}

template <int Dim> void LatticePart<Dim>::number_halo(const field::RowHalo& halo)
{
  for (std::size_t k = 0; k < halo_at_.size(); ++k)
    local_rows_[static_cast<std::size_t>(halo_at_[k])] = halo.local(halo_rows_[k]);
}

template <int Dim>
Vector<Dim> LatticePart<Dim>::relative(const Window& window, Index k, std::size_t arm, int sign) const
{
  const std::ptrdiff_t i = at(where_.active.site(sites_[static_cast<std::size_t>(k)]));
  const std::ptrdiff_t j = i + sign * arms_[arm].jump;
  Vector<Dim> eta;
  for (std::size_t d = 0; d < Dim; ++d)
    eta[static_cast<Eigen::Index>(d)] = window[d][static_cast<std::size_t>(j)] - window[d][static_cast<std::size_t>(i)];
  return eta;
}

template <int Dim> typename LatticePart<Dim>::Window LatticePart<Dim>::window() const
{
  Window window;
  for (auto& component : window) component.assign(static_cast<std::size_t>(window_size_), 0.0);
  return window;
}

template <int Dim>
std::span<const double> LatticePart<Dim>::exchange(std::span<const double> owned,
                                                   const std::function<void()>& meanwhile) const
{
  static Event event("pd_halo");
  int ranks = 1;
  MPI_Comm_size(rows_.comm, &ranks);
  if (ranks == 1) {
    meanwhile();
    return {};
  }
  const double* mine = owned.data() + static_cast<std::ptrdiff_t>(first_row_) * Dim;
  {
    Timed timed(event);
    PDX_CALL(PetscSFBcastBegin(halo_sf_.get(), block_type(Dim), mine, halo_buffer_.data(), MPI_REPLACE));
  }
  meanwhile();
  const double begin = MPI_Wtime();
  PDX_CALL(PetscSFBcastEnd(halo_sf_.get(), block_type(Dim), mine, halo_buffer_.data(), MPI_REPLACE));
  waited_ += MPI_Wtime() - begin;
  return halo_buffer_;
}

template <int Dim> void LatticePart<Dim>::load(std::span<const double> owned, Window& window) const
{
  const std::span<const double> halo = exchange(owned, [&] {
    for (const Run& run : segments_) {
      const double* from = owned.data() + static_cast<std::ptrdiff_t>(run.row) * Dim;
      std::array<double*, Dim> to;
      for (std::size_t d = 0; d < Dim; ++d) to[d] = window[d].data() + run.at;
      for (std::ptrdiff_t k = 0; k < run.length; ++k)
        for (std::size_t d = 0; d < Dim; ++d) to[d][k] = from[k * Dim + static_cast<std::ptrdiff_t>(d)];
    }
  });
  for (std::size_t k = 0; k * Dim < halo.size(); ++k)
    for (std::size_t d = 0; d < Dim; ++d) window[d][static_cast<std::size_t>(halo_at_[k])] = halo[k * Dim + d];
}

template <int Dim> BondView<Dim> LatticePart<Dim>::view(const Window& window) const
{
  BondView<Dim> view{};
  for (std::size_t d = 0; d < Dim; ++d) view.u[d] = window[d].data();
  view.words = {words_[0].data(), words_[1].data()};
  view.classes = classes_.empty() ? nullptr : classes_.data();
  view.factors = factors_.data();
  view.arms = arms_;
  view.swelling = swelling_.empty() ? nullptr : swelling_.data();
  return view;
}

template <int Dim> void LatticePart<Dim>::swell(const field::FreeStrain& strain)
{
  swelling_.resize(static_cast<std::size_t>(window_size_));
  const auto take = [&](std::ptrdiff_t i) {
    const Vector<Dim> x = where_.lattice.point(site_at(i));
    swelling_[static_cast<std::size_t>(i)] = 0.5 * strain(x.template head<2>());
  };
  for (const Run& run : segments_)
    for (Index k = 0; k < run.length; ++k) take(run.at + k);
  for (const std::ptrdiff_t i : halo_at_) take(i);
}

template <int Dim> double LatticePart<Dim>::free_strain(Index k, std::size_t arm, int sign) const
{
  if (swelling_.empty()) return 0.0;
  const std::ptrdiff_t i = at(where_.active.site(sites_[static_cast<std::size_t>(k)]));
  return free_strain(sign > 0 ? i : i - arms_[arm].jump, arm);
}

template class LatticePart<2>;
template class LatticePart<3>;
} // namespace pdx::pd
