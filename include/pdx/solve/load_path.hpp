#pragma once
#include <cstdint>

namespace pdx::solve {
/// Which load comes next: equal increments from 0 to 1, each halved where it must be and grown back where it may.
/// Counts in parts of an increment, so the ends of increments are always hit exactly.
class LoadPath {
public:
  /// @param max_halvings at most 30
  LoadPath(int increments, int max_halvings);
  bool done() const { return increment_ == increments_; }
  double target() const;                           ///< the load to try now [-]
  double reached() const;                          ///< the load before [-]
  double size() const;                             ///< of the part tried now [-]
  int increment() const { return increment_ + 1; } ///< the increment it lies in, from 1
  void advance();                                  ///< the target was reached
  bool halve();                                    ///< it was not; false: this is the smallest part already

  /// Where a path is, whatever halvings it allows.
  struct Place {
    int increments = 0;            ///< reached as a whole
    double done = 0.0, size = 1.0; ///< of the next one: reached, and tried now; powers of two and their sums [-]
  };
  Place place() const;
  /// Goes on from there. False, and nothing has changed: it lies within a part smaller than any of this path.
  bool go_on_from(const Place& place);

private:
  int increments_, increment_ = 0;
  std::int64_t parts_, at_ = 0, size_; // parts of an increment: all, done, tried now
};
} // namespace pdx::solve
