#pragma once
#include "pdx/base/error.hpp"
#include "pdx/field/force_loss.hpp"
#include "pdx/law/bond.hpp"
#include "pdx/pd/cloud.hpp"
#include "pdx/pd/csr_kernel.hpp"

namespace pdx::pd {
/// What the bonds of a cloud are made from. SI units.
struct CloudOptions {
  double horizon = 0.0;   ///< delta                                                        [m]
  double thickness = 1.0; ///< out of plane, equal to elastic.thickness; unused in 3-D       [m]
  law::Micromodulus micromodulus = law::Micromodulus::conical;
  law::Elastic elastic;
};

/// Side of a particle seen as a square as thick as the body, or as a cube [m].
template <int Dim> double particle_size(double volume, double thickness);

/// How far bonds reach: the horizon, with a uniform micromodulus and half a particle of that volume [m].
template <int Dim> double bond_reach(const CloudOptions& options, double largest_volume);

/// That no particle has a neighbour within the horizon [m].
UserError no_neighbours(double horizon);

/// The bonds of particles that lie anywhere. Bond force per unit stretch kappa = c(xi) beta V_i V_j, where beta is the
/// part of the neighbour's volume in the horizon by its size dx = V^(1/Dim) (2-D: sqrt(V / thickness)), the mean of
/// both ends', so that forces are in balance. Constants are those of the continuum: nothing is calibrated.
template <int Dim> class CsrPart {
public:
  /// @param cloud its first `owned` particles are this rank's, those after them its halo: all others within the horizon
  ///              and half a particle of one of them. Sets are not looked at.
  /// @param numbers of the particles: each one's bonds stand, and forces are summed, in their order, so that results do
  ///                not depend on who owns what; none: in the order of the cloud
  /// Throws UserError for options that are not positive, a wrong Poisson's ratio, particles in one place, and a horizon
  /// in which no particle has a neighbour (if all are owned).
  CsrPart(const Cloud<Dim>& cloud, Index owned, const CloudOptions& options, std::span<const Index> numbers = {});

  CsrView<Dim> view() const;
  std::int64_t bonds() const; ///< intact entries: bonds between owned particles count twice
  std::span<const std::uint8_t> intact() const { return intact_; } ///< as view().intact
  std::span<const double> volumes() const { return volumes_; }     ///< of all particles [m^3]
  /// sum_j mu beta V_j of the owned particles, see damage.hpp [m^3]
  std::vector<double> bonded_volume() const;
  /// r += internal force at u.  @param u rows of Dim, [owned | halo]   @param r owned rows
  CsrSeen add_force(Kinematics kinematics, double critical_stretch, std::span<const double> u, std::span<double> r,
                    bool energy = false) const;
  /// Breaks what is overstretched; of a bond, the rank of the end with the smaller x (then y, z) counts it.
  /// @param losses if not null, the forces of the broken bonds on owned rows are appended
  Broken break_bonds(const BreakRule& rule, std::span<const double> u, field::ForceLosses* losses = nullptr);
  /// Takes out the bonds that a crack parts; in 3-D cracks reach through the body. Counted as by break_bonds.
  std::int64_t cut(const crack::CrackSet& cracks);
  /// Takes out the bonds that are 0 there, entries as those of `intact`.
  void keep_only(std::span<const std::uint8_t> intact);
  void restore(std::span<const std::uint8_t> intact) { intact_.assign(intact.begin(), intact.end()); }

private:
  bool counts(std::size_t i, std::size_t j) const;
  double kappa(double length, double volume_i, double volume_j) const; // [N]
  double share(double length, double volume) const;                    // beta
  void add_bonds_of(Index i, const Cloud<Dim>& cloud, std::span<const Index> near);

  CloudOptions options_;
  law::BondLaw<Dim> law_;
  Processor processor_ = chosen_processor();
  std::vector<std::int64_t> first_{0};
  std::vector<std::int32_t> neighbour_;
  std::vector<std::uint8_t> intact_;
  std::vector<double> length_, weight_, points_, volumes_;
};
} // namespace pdx::pd
