#pragma once
#include "pdx/field/row_name.hpp"
#include "pdx/field/system.hpp"

#include <Eigen/Core>
#include <memory>

namespace pdx::solve {
/// Which nodes and enriched sets of a System must stay unknowns if all others are eliminated.
struct Border {
  std::vector<Index> kept; ///< owned rows: those that Terms with a changing tangent or the coarse level of particles
                           ///< touch, with the nodes of sets and the sets of nodes; ascending
  std::int64_t kept_components = 0, eliminated_components = 0; ///< of all ranks, prescribed ones included
};
/// Collective.
Border border_of(const field::System& system);

class LastingCore;
class StagedElimination;

/// What outlives the layouts of a scene that changes, so that a small change costs little.
struct Lasting {
  std::vector<field::RowName> names; ///< of our owned rows in the layout at hand
  std::shared_ptr<LastingCore> core; ///< of the first rank
};

/// The matrix K of the fixed Terms, with the eliminated components I condensed onto the kept ones G:
/// S = K_GG - K_GI K_II^-1 K_IG, dense. One rank eliminates for all.
class Condensation {
public:
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// @param system must outlive it   @param lasting null: no other layout is to come. Collective.
  Condensation(const field::System& system, Border border, Lasting* lasting = nullptr);
  ~Condensation();
  Condensation(const Condensation&) = delete;
  Condensation& operator=(const Condensation&) = delete;

  /// "" or why there is none: no package to eliminate with, or something hangs on nothing that is held or kept.
  const std::string& fault() const { return fault_; }
  const Border& border() const { return border_; }
  /// Number of our first kept component among those of all ranks, which stand in order of ranks.
  Index first() const { return first_; }
  Index size() const { return size_; }                   ///< kept components of all ranks
  const Matrix& stiffness() const { return stiffness_; } ///< ours x all [N/m]
  /// External force at load 1 on our kept components, with what loads and prescribed displacements of eliminated ones
  /// come to there [N].
  const std::vector<double>& load() const { return load_; }
  /// Writes the eliminated components of u: in equilibrium with the kept ones in it, and at their prescribed values.
  /// Collective. @param u owned rows * dim [m]
  void recover(double load, std::span<double> u) const;

private:
  void sort_components();
  void gather(std::vector<double>& load) const;
  std::vector<double> ours(const std::vector<double>& all, std::size_t first, std::size_t count) const;

  const field::System& system_;
  Border border_;
  std::string fault_;
  std::vector<Index> kept_, free_, held_; // our components: kept, eliminated, eliminated by being prescribed
  std::vector<double> targets_;           // of held_ at load 1 [m]
  std::size_t first_free_ = 0;            // number of our first one among those of all ranks
  Index first_ = 0, size_ = 0;
  std::unique_ptr<StagedElimination> inner_; // of the first rank
  Matrix stiffness_;
  std::vector<double> load_;
};
} // namespace pdx::solve
