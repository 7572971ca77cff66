#pragma once
#include <span>
#include <vector>

namespace pdx::field {
/// What moves a System by steps of its own, where forces on its rows do not say how it moves: rows then tell where its
/// parts are and how fast. All but `work` are collective.
class OwnSteps {
public:
  virtual ~OwnSteps() = default;
  /// From one time to another. @param first of a run, which begins at rest in time [s]
  /// Throws SolverFailure, alike on all ranks, where it cannot go on.
  virtual void step(double from, double to, bool first) = 0;
  /// Displacement [m] and velocity [m/s] of the owned rows, at the end of the last step.
  /// @param length of it [s]
  virtual void tell(double length, std::span<double> u, std::span<double> v) const = 0;
  virtual double work() const = 0; ///< done on it since the start, this rank's part [J]

  /// All that steps go on from, to the last bit: so many numbers for each owned row.
  ///@{
  virtual int width() const = 0;
  virtual void inner(std::vector<double>& all) const = 0;
  virtual void resume(double time, std::span<const double> inner, double work) = 0;
  ///@}
};
} // namespace pdx::field
