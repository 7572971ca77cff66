#pragma once
#include "pdx/solve/condensation.hpp"

namespace pdx::solve {
/// Where the rows of a condensed System are in the whole one, and room to show whole arrays to those who know no other.
class KeptRows {
public:
  /// Collective.
  KeptRows(const field::System& whole, std::span<const Index> kept);
  const field::System& whole() const { return whole_; }
  const field::Rows& rows() const { return rows_; }
  std::vector<PetscInt> needed() const; ///< our halo
  void bind(const field::RowHalo& halo);
  /// Global condensed row of every local row of the whole System, -1 where it was eliminated.
  std::span<const PetscInt> renumbered() const { return renumbered_; }
  /// Whole row of an owned one.
  Index whole_row(Index row) const { return owned_[static_cast<std::size_t>(row)]; }
  Index kept_row(Index whole) const; ///< -1: eliminated
  /// A local array of the whole System: condensed values in their places, those of eliminated rows are of no matter.
  std::span<const double> widened(std::span<const double> local) const;
  /// Values of owned rows, from and to owned ones of the whole System.
  void narrow(std::span<const double> whole, std::span<double> owned) const;
  void widen(std::span<const double> owned, std::span<double> whole) const;

private:
  const field::System& whole_;
  field::Rows rows_;
  std::vector<Index> owned_;          // whole rows of ours, ascending; particles last
  std::vector<Index> halo_;           // whole local rows of our halo
  std::vector<PetscInt> renumbered_;  // per local row of the whole System
  mutable std::vector<double> local_; // dim per local row of the whole System
};

/// A System of what a Condensation leaves: its stiffness as one Term, the other Terms as they are, on fewer rows.
/// Whatever solves Systems solves this one; the whole System must outlive it.
class CondensedSystem {
public:
  /// @param condensation without fault. Collective.
  CondensedSystem(const field::System& whole, const Condensation& condensation);
  const field::System& system() const { return system_; }
  void narrow(Vec whole, Vec condensed) const;
  std::vector<double> narrowed(std::span<const double> whole) const;
  /// The whole displacement in equilibrium at a load. Collective.
  void recover(Vec condensed, double load, Vec whole) const;

private:
  void add_prescribed();
  const Condensation& condensation_;
  KeptRows kept_;
  field::System system_;
};
} // namespace pdx::solve
