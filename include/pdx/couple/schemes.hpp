#pragma once
#include "pdx/couple/carried_bonds.hpp"
#include "pdx/geom/frame.hpp"
#include "pdx/pd/lattice_part.hpp"

#include <memory>

namespace pdx::couple {
/// How bonds that leave a patch act on the elements around it.
/// energy:    the inner part of the bond is a spring from the particle to the point where it meets the interface,
///            carried by the mesh edge; bonds that clip a corner act between their two intersection points. Symmetric,
///            exact for constant strain. No ghost particles.
/// ghost:     the papers' scheme: the outer end is a ghost particle carried by its element.  [XPD1 Eqs. 14-18]
/// interface: ghosts for the displacement, force at the point where the bond meets the interface. Not symmetric.
/// handshake: ghosts beside patches of any shape: all bonds of a particle act whole, whatever lies on their way, on
///            the material point, or on what would be one, at the other end.  [APDMPM Eqs. 23-25, 29, 36-38]
enum class Scheme { energy, ghost, interface, handshake };
/// The option that asks for it.
constexpr const char* option_of(Scheme scheme)
{
  constexpr const char* options[] = {"-couple_scheme energy", "-couple_scheme ghost", "-couple_scheme interface",
                                     "-mpm_coupling handshake"};
  return options[static_cast<int>(scheme)];
}

struct CouplingOptions {
  Scheme scheme = Scheme::energy;
  law::Kinematics kinematics = law::Kinematics::small;
  const crack::CrackSet* cracks = nullptr; ///< bonds whose acting part they part carry nothing
  const crack::CrackSet* seams = nullptr;  ///< the same, where the mesh is parted
  std::span<const geom::Box<2>> no_fail;   ///< bonds with an end in one of them never break [m]
  /// energy: particles whose bonds leave a patch hand mass to where they do: of this density, a particle's times
  /// w (xi - l) over the sum of w xi of all its bonds, w their stiffness, xi - l what lies outside. 0: none [kg/m^3]
  double handed_density = 0.0;
  geom::Frame frame = {};                ///< of coordinates in messages
  const law::Regions* regions = nullptr; ///< of other materials than the patches' stencils; null: none
};

/// Where the material around a patch counts to bond families: everywhere, or (papers) in the ghost layers only. In the
/// energy scheme a bond that meets the interface acts up to there, so what lies behind elements counts even where the
/// body ends within a horizon: the outer part is the elements' business.
pd::Exists<2> family_of(const Surroundings& around, const pd::Stencil<2>& stencil, Scheme scheme);

/// Keys of carried bonds: their bond's name times this, and the number of the part; more than a bond has pieces.
inline constexpr std::uint64_t kPartsOfBonds = 32;

/// The bond of the lattice that a carried bond is, or is a part of, by the key of that; none if it is of another
/// lattice.
std::optional<pd::LatticePart<2>::BondAt> lattice_bond(std::uint64_t key, const geom::SiteNames& names,
                                                       const pd::Stencil<2>& stencil);

/// A bond of a lattice: its lower end as `geom::SiteNames` calls it, and its half arm.
struct BondName {
  std::uint64_t lower;
  std::size_t arm;
};
/// The same of a key that is known to be of this lattice.
BondName bond_name(std::uint64_t key, const geom::SiteNames& names, const pd::Stencil<2>& stencil);

/// Of the layout before.
struct KeptFamilies {
  CarriedBonds<2>::Families families = {};                ///< one per patch, null for a new one; none: all are new
  std::shared_ptr<const field::RowShift> shift = nullptr; ///< of their rows
};

/// The carried bonds of all patches that touch a row of this rank. Collective.
/// Throws UserError if a patch lies so near to another that its ghosts find no element.
std::unique_ptr<CarriedBonds<2>> carry_bonds(const field::Rows& rows, const CouplingOptions& options,
                                             std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                             std::span<const Surroundings> around, KeptFamilies kept = {});

/// Ghost particles of all patches: outside sites that carry at least one bond [-].
Index count_ghosts(std::span<const Surroundings> around, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts);
} // namespace pdx::couple
