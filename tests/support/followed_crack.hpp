#pragma once
#include "pdx/track/follow.hpp"
#include "support/cracked_lattice.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace pdx::test {
inline constexpr double kPi = 3.14159265358979323846;

inline Vector<2> towards(double degrees) { return {std::cos(degrees * kPi / 180.0), std::sin(degrees * kPi / 180.0)}; }
inline double beside(const Vector<2>& direction, const Vector<2>& x)
{
  return direction[0] * x[1] - direction[1] * x[0];
}

/// Square root of the mean square, and the largest.
struct Errors {
  void add(double error)
  {
    squares += error * error;
    most = std::max(most, std::abs(error));
    ++count;
  }
  double rms() const { return std::sqrt(squares / count); }
  double squares = 0.0, most = 0.0;
  int count = 0;
};

/// Calls visit(x, number of the crossing) for points all along a path.
template <class Visit> void walk(const std::vector<track::Crossing>& crossings, Visit&& visit)
{
  for (std::size_t c = 0; c < crossings.size(); ++c)
    for (int k = 0; k <= 10; ++k) visit(Vector<2>(crossings[c].in + 0.1 * k * (crossings[c].out - crossings[c].in)), c);
}

inline bool on_border(const geom::Box<2>& cell, const Vector<2>& x)
{
  return cell.contains(x) &&
         (x[0] == cell.lower[0] || x[0] == cell.upper[0] || x[1] == cell.lower[1] || x[1] == cell.upper[1]);
}

/// Whatever the crack: a chain of crossings, each from border to border of a cell of its own.
inline void expect_chain(const track::Followed& followed, const std::vector<geom::Box<2>>& cells, const Vector<2>& from)
{
  Vector<2> end = from;
  std::set<std::size_t> seen;
  for (const track::Crossing& crossing : followed.crossings) {
    EXPECT_LE((crossing.in - end).norm(), seen.empty() ? 0.01 : 0.0);
    EXPECT_TRUE(on_border(cells[crossing.cell], crossing.out));
    EXPECT_GT((crossing.out - crossing.in).norm(), 0.0);
    EXPECT_TRUE(seen.insert(crossing.cell).second);
    end = crossing.out;
  }
  EXPECT_NEAR(followed.direction.norm(), 1.0, 1e-12);
}

struct Straight {
  CrackedLattice plate;
  Vector<2> from, direction, tip;
};

/// A crack from the left side of a plate on.
inline Straight straight_crack(double degrees, double ratio, std::mt19937& random)
{
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const Vector<2> from(0.0, 3.0 + 5.0 * share(random)), direction = towards(degrees);
  Straight crack{CrackedLattice({72, 64}, ratio), from, direction, from + (42.0 + 4.0 * share(random)) * direction};
  crack.plate.cut({from, crack.tip});
  return crack;
}

/// A crack along an arc from the left side of a plate of 64 x 64 on.
struct Arc {
  /// @param turn +1 to the left, -1 to the right
  Arc(double r, double turn, std::mt19937& random) : radius(r)
  {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const double length = std::min(40.0, radius), begin = 0.1 * share(random) * turn;
    const Vector<2> from(0.0, turn > 0.0 ? 4.0 + 5.0 * share(random) : 60.0 - 5.0 * share(random));
    const auto normal = [&](double s) {
      return Vector<2>(-std::sin(begin + turn * s / radius), std::cos(begin + turn * s / radius));
    };
    centre = from + turn * radius * normal(0.0);
    for (int p = 0; p <= 120; ++p) points.push_back(centre - turn * radius * normal(length * p / 120));
    direction = {std::cos(begin), std::sin(begin)};
    onwards = {normal(length)[1], -normal(length)[0]};
  }
  double beside(const Vector<2>& x) const { return (x - centre).norm() - radius; } ///< distance from the whole circle

  double radius;
  Vector<2> centre, direction, onwards; ///< unit vectors at its start and at its tip
  crack::Polyline points;
};
} // namespace pdx::test
