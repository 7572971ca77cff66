#pragma once
#include <cstdint>
#include <span>

namespace pdx::field {
/// What may change a scene between two solves at one load (bonds that break). Never called inside a residual, so that
/// Newton sees a smooth problem and a rejected step costs nothing.
class AfterSolve {
public:
  virtual ~AfterSolve() = default;
  /// Judges the equilibrium and changes the scene. @param u local blocks [owned | halo] [m]
  /// @return number of changes on all ranks; 0: quiet, the step may be accepted. Collective.
  virtual std::int64_t apply(std::span<const double> u) = 0;
  /// Remembers the state; `restore` goes back to the state remembered last, as often as asked. The state at
  /// construction counts as remembered.
  virtual void save() = 0;
  virtual void restore() = 0;
};
} // namespace pdx::field
