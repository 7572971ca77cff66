#pragma once
#include "pdx/field/force_loss.hpp"

#include <span>

namespace pdx::field {
/// What may change a scene between two time steps (bonds that break). Called after each step, at the displacement the
/// forces were evaluated at last. Not collective: nothing travels, so that a step in which nothing happens costs
/// nothing.
class AfterStep {
public:
  virtual ~AfterStep() = default;
  /// @param u local blocks [owned | halo] [m]
  /// @param losses what the change took from the internal forces at u is appended: the step that ended felt them, the
  ///        next one does not, and neither energy nor momentum goes astray
  virtual void apply(std::span<const double> u, ForceLosses& losses) = 0;
  /// Called before `apply`. @param length of the step that ended [s]
  virtual void stepped(double length) { (void)length; }
  /// Energy that changes have taken out of the Terms since the start, this rank's part [J].
  virtual double dissipated() const { return 0.0; }
  /// Remembers the state; `restore` goes back to the state remembered last, as often as asked. The state at
  /// construction counts as remembered.
  virtual void save() = 0;
  virtual void restore() = 0;
};
} // namespace pdx::field
