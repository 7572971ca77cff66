#pragma once
#include "pdx/solve/dense_elimination.hpp"
#include "pdx/solve/lasting_core.hpp"

namespace pdx::solve {
/// The free components of elements, eliminated in two stages: a core that lasts from layout to layout, and densely what
/// is between the core and the kept components.
class StagedElimination {
public:
  /// @param core of the layout before, or null; becomes that of this one. A null pointer: it need not last
  /// @param condensed becomes K_GG - K_GI K_II^-1 K_IG, row by row
  StagedElimination(const ElementsOfLayout& elements, std::shared_ptr<LastingCore>* core,
                    std::vector<double>& condensed);
  const std::string& fault() const { return fault_; } ///< "" or why there is none
  /// Of a force at load 1 on all components, what comes to the kept ones. To be called once before `answer`.
  std::vector<double> condense(const std::vector<double>& force);
  /// Free components in equilibrium at a load with the kept ones.
  std::vector<double> answer(double load, std::span<const double> kept) const;

private:
  DenseSquare between(const ElementsOfLayout& elements) const;

  std::shared_ptr<LastingCore> core_;
  std::vector<PetscInt> rest_;                 // free components that are not of the core, then the kept ones
  std::vector<std::size_t> border_;            // places in rest_ of those around the core
  std::vector<PetscInt> inner_;                // components of the core, in its order
  std::vector<std::size_t> core_to_, rest_to_; // places among the free components
  std::unique_ptr<DenseElimination> dense_;
  std::vector<double> core_loaded_, rest_loaded_; // at load 1: of the core while the rest stands [m], U^-T f
  std::string fault_;
};
} // namespace pdx::solve
