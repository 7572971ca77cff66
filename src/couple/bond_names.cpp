#include "pdx/couple/schemes.hpp"

namespace pdx::couple {
namespace {
Site<2> before(Site<2> site, const Site<2>& step)
{
  for (std::size_t d = 0; d < 2; ++d) site[d] -= step[d];
  return site;
}
} // namespace

std::optional<pd::LatticePart<2>::BondAt> lattice_bond(std::uint64_t key, const geom::SiteNames& names,
                                                       const pd::Stencil<2>& stencil)
{
  const std::uint64_t bond = key / kPartsOfBonds;
  const bool forward = bond % 2;
  const auto arm = static_cast<std::size_t>(bond / 2 % pd::kMaxHalfArms);
  const std::optional<Site<2>> site = names.site(bond / 2 / pd::kMaxHalfArms);
  if (!site || arm >= stencil.half.size()) return std::nullopt;
  return pd::LatticePart<2>::BondAt{forward ? *site : before(*site, stencil.half[arm].step), arm};
}

BondName bond_name(std::uint64_t key, const geom::SiteNames& names, const pd::Stencil<2>& stencil)
{
  const std::uint64_t bond = key / kPartsOfBonds;
  const auto arm = static_cast<std::size_t>(bond / 2 % pd::kMaxHalfArms);
  const std::uint64_t site = bond / 2 / pd::kMaxHalfArms;
  if (bond % 2) return {site, arm};
  const Site<2>& step = stencil.half[arm].step;
  return {site - static_cast<std::uint64_t>((step[1] * names.width + step[0]) * names.lattices), arm};
}
} // namespace pdx::couple
