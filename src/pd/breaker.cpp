#include "pdx/pd/breaker.hpp"

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

/// s > s0 without a root and without cancellation. linear: xi.eta > s0 |xi|^2. finite: |xi + eta| > (1 + s0) |xi|, that
/// is 2 xi.eta + eta.eta > s0 (2 + s0) |xi|^2.
template <int Dim, Kinematics kinematics>
std::int64_t break_span(const BondView<Dim>& view, Span span, const BreakRule& rule, std::uint64_t* words)
{
  const HalfArm<Dim>& arm = view.arms[span.h];
  const double s0 = rule.critical_stretch, factor = kinematics == Kinematics::linear ? s0 : s0 * (2.0 + s0);
  const double limit = factor * arm.length * arm.length;
  const unsigned shift = span.h % 64;
  std::int64_t broken = 0;
  for (std::ptrdiff_t i = span.at; i < span.at + span.length; ++i) {
    double growth = 0.0;
    for (std::size_t d = 0; d < Dim; ++d) {
      const double eta = view.u[d][i + arm.jump] - view.u[d][i];
      growth += (kinematics == Kinematics::linear ? arm.xi[d] : 2.0 * arm.xi[d] + eta) * eta;
    }
    std::uint64_t over = growth > limit;
    if (rule.no_fail) over &= (rule.no_fail[i] | rule.no_fail[i + arm.jump]) == 0;
    over &= words[i] >> shift;
    words[i] &= ~(over << shift);
    broken += static_cast<std::int64_t>(over);
  }
  return broken;
}

template <int Dim>
std::int64_t break_any_span(const BondView<Dim>& view, Span span, const BreakRule& rule, BondWords words)
{
  std::uint64_t* plane = words[span.h / 64];
  return rule.kinematics == Kinematics::linear ? break_span<Dim, Kinematics::linear>(view, span, rule, plane)
                                               : break_span<Dim, Kinematics::finite>(view, span, rule, plane);
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
  std::int64_t broken = 0;
  for (const Run& run : runs)
    for (std::size_t h = 0; h < view.arms.size(); ++h)
      broken += break_any_span(view, Span{h, run.at, run.length}, rule, words);
  for (const Run& run : runs) // those that end here; where they start here too, they are broken and counted already
    for (std::size_t h = 0; h < view.arms.size(); ++h)
      break_any_span(view, Span{h, run.at - view.arms[h].jump, run.length}, rule, words);
  return broken;
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
} // namespace pdx::pd
