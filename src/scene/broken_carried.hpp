#pragma once
#include "pdx/couple/space_bonds.hpp"
#include "pdx/pd/bond_term.hpp"
#include "pdx/scene/dormant.hpp"
#include "pdx/scene/part.hpp"

#include <algorithm>
#include <set>

namespace pdx::scene {
/// Which bonds are broken under another layout, of those that were carried before or are now. By the names of the
/// lattices of the patches as they are now. @tparam Names geom::SiteNames in the plane, geom::SpaceNames in space
template <int Dim, class Names> class BrokenCarried {
public:
  struct Lattice {
    const Names& names;
    const pd::Stencil<Dim>& stencil;
  };
  explicit BrokenCarried(std::vector<Lattice> lattices) : lattices_(std::move(lattices)) {}

  /// Bonds that left their patch when they broke, and lie in it now. @param carried keys, of all ranks
  void break_joined(pd::BondTerm<Dim>& bonds, const std::vector<std::uint64_t>& carried) const
  {
    for (std::size_t p = 0; p < bonds.parts().size(); ++p) {
      if (bonds.is_kept(p)) continue; // knows
      std::vector<typename pd::LatticePart<Dim>::BondAt> within;
      const pd::LatticePart<Dim>& part = *bonds.parts()[p];
      for (const std::uint64_t key : carried) {
        const auto bond = couple::lattice_bond(key, lattices_[p].names, part.stencil());
        if (bond && part.active().has(bond->lower) && part.begins(bond->lower, bond->arm)) within.push_back(*bond);
      }
      if (!within.empty()) bonds.set_gone(p, within);
    }
  }

  /// Keys of the carried bonds that are broken: those that were carried then, and those that lay in a patch. Lines are
  /// parted elsewhere: of a bond with a broken part no part heals. Collective.
  std::vector<std::uint64_t> keys(const couple::CarriedBonds<Dim>& carried, const BrokenBonds& before) const
  {
    std::vector<std::uint64_t> keys;
    std::vector<std::size_t> arms;
    std::vector<std::uint64_t> broken; // none were carried where all were particles
    if (before.carried) broken = *before.carried;
    const std::set<std::uint64_t> parted = parted_bonds(broken);
    std::vector<field::RowName> lower; // ends of the bonds
    carried.for_each_new_key([&](std::uint64_t key, Index patch) {
      const Lattice& lattice = lattices_[static_cast<std::size_t>(patch)];
      const auto [site, arm] = couple::bond_name(key, lattice.names, lattice.stencil);
      if (parted.contains(site * pd::kMaxHalfArms + arm)) broken.push_back(key);
      keys.push_back(key);
      arms.push_back(arm);
      lower.push_back(field::RowName::particle(site));
    });
    const std::vector<std::uint64_t> gone = before.words_of(lower);
    for (std::size_t k = 0; k < keys.size(); ++k)
      if (gone[kLatticeWords * k + arms[k] / 64] >> (arms[k] % 64) & 1u) broken.push_back(keys[k]);
    std::ranges::sort(broken);
    return broken;
  }

private:
  /// Bonds of which some part had broken that was carried.
  std::set<std::uint64_t> parted_bonds(const std::vector<std::uint64_t>& carried) const
  {
    std::set<std::uint64_t> bonds;
    for (const std::uint64_t key : carried)
      for (const Lattice& lattice : lattices_)
        if (const auto bond = couple::lattice_bond(key, lattice.names, lattice.stencil)) {
          bonds.insert(lattice.names.of(bond->lower) * pd::kMaxHalfArms + bond->arm);
          break;
        }
    return bonds;
  }

  std::vector<Lattice> lattices_;
};
} // namespace pdx::scene
