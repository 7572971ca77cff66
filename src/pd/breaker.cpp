#include "pdx/pd/breaker.hpp"

#include "pdx/base/lanes.hpp"

#include <algorithm>
#include <bit>

namespace pdx::pd {
namespace {
/// The bonds of half arm h that start at `length` neighbouring sites from window index `at`.
struct Span {
  std::size_t h;
  std::ptrdiff_t at;
  Index length;
};

/// As `load`, of the first `count` entries; the others are 0.
template <int W, class T> PDX_INLINE auto load_first(const T* p, std::ptrdiff_t count)
{
  decltype(load<W>(p)) x{};
  if (count >= W) return load<W>(p);
  for (std::ptrdiff_t l = 0; l < count; ++l) x[l] = p[l];
  return x;
}

/// s > s0 without a root and without cancellation. linear: xi.eta > s0 |xi|^2. finite: |xi + eta| > (1 + s0) |xi|, that
/// is 2 xi.eta + eta.eta > s0 (2 + s0) |xi|^2. Lanes to the last bond: all are rounded alike, on every rank. Where
/// sites swell, s0 is counted from the bond's free strain.
template <int Dim, Kinematics kinematics, bool swells> struct BreakSpans {
  const BondView<Dim>& view;
  std::span<const Span> spans;
  const BreakRule& rule;
  BondWords words;
  std::int64_t& broken;

  template <int W> PDX_INLINE void run() const
  {
    for (const Span& span : spans) {
      typename Simd<W>::Mask any{};
      for (Index k = 0; k < span.length; k += W)
        any |= over<W>(span, span.at + k, span.length - k, least_stretch(),
                       growth_of<W>(span.h, span.at + k, span.length - k));
      for (int l = 0; l < W; ++l)
        if (any[l]) {
          break_span<W>(span);
          break;
        }
    }
  }

private:
  /// What the growth of a bond along the half arm must exceed.
  PDX_INLINE double limit(std::size_t h, double s0) const
  {
    const double factor = kinematics == Kinematics::small ? s0 : s0 * (2.0 + s0);
    return factor * view.arms[h].length * view.arms[h].length;
  }
  /// The least s0 that any bond has.
  PDX_INLINE double least_stretch() const
  {
    return rule.critical_stretch * rule.least_share * (rule.regions ? rule.regions->least_stretch() : 1.0);
  }

  template <int W> PDX_INLINE Lanes<W> growth_of(std::size_t h, std::ptrdiff_t i, std::ptrdiff_t count) const
  {
    const HalfArm<Dim>& arm = view.arms[h];
    Lanes<W> growth{};
    for (std::size_t d = 0; d < Dim; ++d) {
      const Lanes<W> eta = load_first<W>(view.u[d] + i + arm.jump, count) - load_first<W>(view.u[d] + i, count);
      if constexpr (kinematics == Kinematics::small)
        growth += arm.xi[d] * eta;
      else
        growth += (2.0 * arm.xi[d] + eta) * eta;
    }
    return growth;
  }
  /// Is it too much for a critical stretch?
  template <int W>
  PDX_INLINE typename Simd<W>::Mask over(const Span& span, std::ptrdiff_t i, std::ptrdiff_t count, double s0,
                                         Lanes<W> growth) const
  {
    if constexpr (swells) {
      const HalfArm<Dim>& arm = view.arms[span.h];
      const double* const free = view.swelling + i;
      const Lanes<W> most = s0 + (load_first<W>(free, count) + load_first<W>(free + arm.jump, count));
      return growth > (kinematics == Kinematics::small ? most : most * (2.0 + most)) * (arm.length * arm.length);
    } else {
      return growth > limit(span.h, s0);
    }
  }
  /// Is growth too much for this very bond, where they differ?
  PDX_INLINE bool is_over(std::size_t h, std::ptrdiff_t i, double growth) const
  {
    const std::ptrdiff_t j = i + view.arms[h].jump;
    double s0 = rule.critical_stretch;
    if (rule.regions) s0 *= rule.regions->stretch(rule.region[i], rule.region[j]);
    if (rule.shares) s0 *= 1.0 + (rule.shares[i] + rule.shares[j]);
    return growth > limit(h, swells ? s0 + (view.swelling[i] + view.swelling[j]) : s0);
  }

  template <int W> PDX_INLINE void break_span(const Span& span) const
  {
    std::uint64_t* plane = words[span.h / 64];
    const std::uint64_t bit = std::uint64_t{1} << span.h % 64;
    const std::ptrdiff_t jump = view.arms[span.h].jump, end = span.at + span.length;
    for (std::ptrdiff_t first = span.at; first < end; first += W) {
      const Lanes<W> growth = growth_of<W>(span.h, first, end - first);
      const typename Simd<W>::Mask gone = over<W>(span, first, end - first, least_stretch(), growth);
      for (std::ptrdiff_t i = first; i < std::min<std::ptrdiff_t>(first + W, end); ++i) {
        if (!gone[i - first] || !(plane[i] & bit)) continue;
        if (rule.no_fail && (rule.no_fail[i] || rule.no_fail[i + jump])) continue;
        if ((rule.regions || rule.shares) && !is_over(span.h, i, growth[i - first])) continue;
        plane[i] &= ~bit;
        ++broken;
      }
    }
  }
};

template <int Dim, bool swells>
std::int64_t break_spans(const BondView<Dim>& view, std::span<const Span> spans, const BreakRule& rule, BondWords words)
{
  std::int64_t broken = 0;
  if (rule.kinematics == Kinematics::small)
    run_here(BreakSpans<Dim, Kinematics::small, swells>{view, spans, rule, words, broken});
  else
    run_here(BreakSpans<Dim, Kinematics::finite, swells>{view, spans, rule, words, broken});
  return broken;
}

/// Appends the parts of a span that lie in no run.
void append_outside(std::span<const Run> ascending, const Span& span, std::vector<Span>& spans)
{
  std::ptrdiff_t from = span.at;
  const std::ptrdiff_t end = span.at + span.length;
  auto run = std::upper_bound(ascending.begin(), ascending.end(), from,
                              [](std::ptrdiff_t at, const Run& r) { return at < r.at + r.length; });
  for (; from < end; ++run) {
    const std::ptrdiff_t stop = run == ascending.end() ? end : std::min(end, run->at);
    if (stop > from) spans.push_back({span.h, from, static_cast<Index>(stop - from)});
    if (run == ascending.end()) return;
    from = std::max(from, run->at + run->length);
  }
}

/// Calls visit(window index, site) for all sites of the window.
template <int Dim, class Visit> void for_each_site(const WindowSites<Dim>& sites, Visit&& visit)
{
  std::ptrdiff_t total = 1;
  for (const Index n : sites.extent) total *= n;
  Site<Dim> site = sites.lower;
  for (std::ptrdiff_t at = 0; at < total; ++at) {
    visit(at, site);
    for (std::size_t d = 0; d < Dim; ++d) {
      if (++site[d] < sites.lower[d] + sites.extent[d]) break;
      site[d] = sites.lower[d];
    }
  }
}

/// Per site of the window: 1 where a particle of the runs is.
template <int Dim> std::vector<std::uint8_t> particles_of(const WindowSites<Dim>& sites, std::span<const Run> runs)
{
  std::size_t total = 1;
  for (const Index n : sites.extent) total *= static_cast<std::size_t>(n);
  std::vector<std::uint8_t> there(total, 0);
  for (const Run& run : runs) std::fill_n(there.begin() + run.at, run.length, std::uint8_t{1});
  return there;
}

template <int Dim> Vector<2> in_plane(const Vector<Dim>& x) { return x.template head<2>(); }
} // namespace

template <int Dim> std::int64_t count_bonds(const BondView<Dim>& view, std::span<const Run> runs)
{
  std::int64_t bonds = 0;
  for (std::size_t plane = 0; plane * 64 < view.arms.size(); ++plane)
    for (const Run& run : runs)
      for (Index k = 0; k < run.length; ++k) bonds += std::popcount(view.words[plane][run.at + k]);
  return bonds;
}

template <int Dim>
std::int64_t break_bonds(const BondView<Dim>& view, std::span<const Run> runs, const BreakRule& rule, BondWords words)
{
  std::vector<Run> ascending(runs.begin(), runs.end());
  std::sort(ascending.begin(), ascending.end(), [](const Run& a, const Run& b) { return a.at < b.at; });
  std::vector<Span> starting, ending;
  for (const Run& run : ascending)
    for (std::size_t h = 0; h < view.arms.size(); ++h) {
      starting.push_back({h, run.at, run.length});
      append_outside(ascending, {h, run.at - view.arms[h].jump, run.length}, ending);
    }
  const auto spans_of = view.swelling ? break_spans<Dim, true> : break_spans<Dim, false>;
  spans_of(view, ending, rule, words); // those of other ranks
  return spans_of(view, starting, rule, words);
}

template <int Dim>
std::int64_t cut_bonds(const crack::CrackSet& cracks, const WindowSites<Dim>& sites, const Stencil<Dim>& stencil,
                       std::span<const Run> runs, BondWords words)
{
  const std::vector<std::uint8_t> counted = particles_of(sites, runs);
  double longest = 0.0;
  for (const Arm<Dim>& arm : stencil.half) longest = std::max(longest, arm.length);
  std::int64_t cut = 0;
  for_each_site<Dim>(sites, [&](std::ptrdiff_t at, const Site<Dim>& site) {
    const Vector<2> a = in_plane<Dim>(sites.lattice.point(site));
    if (!cracks.near(a, longest)) return;
    for (std::size_t h = 0; h < stencil.half.size(); ++h) {
      std::uint64_t& word = words[h / 64][at];
      const std::uint64_t bit = std::uint64_t{1} << h % 64;
      if (!(word & bit)) continue;
      Site<Dim> other = site;
      for (std::size_t d = 0; d < Dim; ++d) other[d] += stencil.half[h].step[d];
      if (!cracks.cuts(a, in_plane<Dim>(sites.lattice.point(other)))) continue;
      word &= ~bit;
      cut += counted[static_cast<std::size_t>(at)];
    }
  });
  return cut;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template std::int64_t count_bonds<Dim>(const BondView<Dim>&, std::span<const Run>);                                  \
  template std::int64_t break_bonds<Dim>(const BondView<Dim>&, std::span<const Run>, const BreakRule&, BondWords);     \
  template std::int64_t cut_bonds<Dim>(const crack::CrackSet&, const WindowSites<Dim>&, const Stencil<Dim>&,           \
                                       std::span<const Run>, BondWords)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
