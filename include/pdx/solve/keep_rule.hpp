#pragma once

namespace pdx::solve {
/// How long a preconditioner is kept: until a solve takes more iterations than `factor` times those of the first solve
/// after the last build, plus 2, or until the iterations spent beyond those of the first solve add up to the price of a
/// build. Solves that reduce their residual by more or fewer decades are compared in proportion.
class KeepRule {
public:
  explicit KeepRule(double factor) : factor_(factor) {}
  bool wants_build() const { return wanted_; }
  void demand() { wanted_ = true; }
  void built();
  /// @param decades log10 of first over last residual norm
  void solved(int iterations, double decades);

private:
  double factor_, per_decade_ = 0.0; // iterations per decade of the first solve after a build; 0: not known yet
  double spent_ = 0.0;               // iterations beyond the expected ones since the build
  bool wanted_ = true;
};
} // namespace pdx::solve
