#include "pdx/couple/carried_runs.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <random>

namespace pdx::test::carried_runs {
using couple::CarriedPoints;
using couple::CarriedRuns;
using couple::RunBond;

namespace {
constexpr double kDx = 0.5, kKappa = 3.0;

/// Rows of particles along a straight side that lies along x, the first kDx / 2 above it, and below it elements of
/// `cell` spacings, with nodes on the side. Bonds go down along arms of up to three spacings and end where they meet
/// the side.
struct Edge {
  struct Bond {
    RunBond<2> run;
    double stiffness;
  };
  Index length, nodes;
  double cell;
  CarriedPoints<2> points;
  std::vector<Bond> bonds;

  /// @param upright rows are numbered across the side, as along one that lies along y
  Edge(Index its_length, double its_cell, bool upright)
      : length(its_length), nodes(static_cast<Index>(std::ceil(length / its_cell)) + 1), cell(its_cell)
  {
    for (Index depth = 0; depth < 3; ++depth)
      for (Index place = 0; place < length; ++place)
        for (Index down = depth + 1; down <= 3; ++down)
          for (Index across = -2; across <= 2; ++across)
            leave(upright ? place * 3 + depth : depth * length + place, place, depth, across, down);
  }
  Index rows() const { return 3 * length + nodes; }

  std::vector<RunBond<2>> run_bonds() const
  {
    std::vector<RunBond<2>> list;
    for (const Bond& bond : bonds) list.push_back(bond.run);
    return list;
  }

  /// Bond by bond, as the law says: kappa s along the turned bond, s = |xi + eta| / |xi| - 1 (or along the reference).
  std::vector<double> forces(const std::vector<double>& u, bool finite, Index owned) const
  {
    std::vector<double> r(static_cast<std::size_t>(2 * owned), 0.0);
    for (const Bond& bond : bonds) {
      const auto rows = points.rows(bond.run.point);
      const auto weights = points.weights(bond.run.point);
      const Vector<2> eta = stretched(u, bond);
      const double rest = bond.run.xi.norm();
      const Vector<2> now = bond.run.xi + eta, along = bond.run.xi / rest;
      const Vector<2> force = bond.stiffness * (finite ? Vector<2>((now.norm() - rest) * now.normalized())
                                                       : Vector<2>(along.dot(eta) * along));
      const auto add = [&](Index row, const Vector<2>& f) {
        if (row >= owned) return;
        r[static_cast<std::size_t>(2 * row)] += f.x();
        r[static_cast<std::size_t>(2 * row + 1)] += f.y();
      };
      add(bond.run.row, -force);
      for (std::size_t k = 0; k < rows.size(); ++k) add(rows[k], weights[k] * force);
    }
    return r;
  }

  /// Sum of 1/2 kappa |xi| s^2 over the bonds of owned particles.
  double energy(const std::vector<double>& u, bool finite, Index owned) const
  {
    double total = 0.0;
    for (const Bond& bond : bonds) {
      const double rest = bond.run.xi.norm();
      const Vector<2> eta = stretched(u, bond);
      const double s = (finite ? (bond.run.xi + eta).norm() - rest : bond.run.xi.dot(eta) / rest) / rest;
      if (bond.run.row < owned) total += 0.5 * bond.stiffness * rest * rest * s * s;
    }
    return total;
  }

private:
  Vector<2> stretched(const std::vector<double>& u, const Bond& bond) const
  {
    const auto at = [&](Index row) { return Eigen::Map<const Vector<2>>(&u[static_cast<std::size_t>(2 * row)]); };
    Vector<2> eta = -at(bond.run.row);
    for (std::size_t k = 0; k < points.rows(bond.run.point).size(); ++k)
      eta += points.weights(bond.run.point)[k] * at(points.rows(bond.run.point)[k]);
    return eta;
  }

  void leave(Index row, Index place, Index depth, Index across, Index down)
  {
    const double share = (depth + 0.5) / down, along = share * across, s = place + 0.5 + along;
    if (across * across + down * down > 10 || s < 0.0 || s > length) return;
    const double in = s / cell;
    const auto element = std::min(static_cast<Index>(in), nodes - 2);
    couple::Host host;
    ASSERT_TRUE(host.add(3 * length + element, 1.0 - (in - element)));
    ASSERT_TRUE(host.add(3 * length + element + 1, in - element));
    RunBond<2> bond;
    bond.number = bonds.size();
    bond.row = row;
    bond.point = points.add(host);
    bond.xi = share * kDx * Vector<2>(across, -down);
    bond.leaves = {0, depth, place, along};
    bonds.push_back({bond, kKappa / bond.xi.norm()});
  }
};

std::vector<double> noise(std::size_t size, double amplitude = 0.02 * kDx)
{
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> number(-amplitude, amplitude);
  std::vector<double> u(size);
  for (double& x : u) x = number(generator);
  return u;
}

std::vector<Processor> processors()
{
  std::vector<Processor> all;
  for (const Processor one : {Processor::any, Processor::avx2, Processor::avx512})
    if (one <= this_processor()) all.push_back(one);
  return all;
}

/// Of all bonds: those in runs by these, the others by the law; largest difference from the law alone over the largest
/// force.
double difference(const Edge& edge, Index owned)
{
  const std::vector<double> u = noise(static_cast<std::size_t>(2 * edge.rows()));
  double worst = 0.0;
  for (const bool finite : {true, false})
    for (const Processor processor : processors()) {
      CarriedRuns<2> runs(edge.points, edge.run_bonds(), owned);
      runs.set_stiffness([&](std::size_t number) { return edge.bonds[number].stiffness; });
      Edge rest = edge;
      for (const std::size_t number : runs.numbers()) rest.bonds[number].stiffness = 0.0;
      std::vector<double> found = rest.forces(u, finite, owned);
      EXPECT_FALSE(runs.add_forces(processor, finite, u, found));
      EXPECT_NEAR(runs.energy(processor, finite, u) + rest.energy(u, finite, owned), edge.energy(u, finite, owned),
                  1e-13 * edge.energy(u, finite, owned));
      const std::vector<double> law = edge.forces(u, finite, owned);
      double largest = 0.0;
      for (const double f : law) largest = std::max(largest, std::abs(f));
      for (std::size_t k = 0; k < law.size(); ++k) worst = std::max(worst, std::abs(found[k] - law[k]) / largest);
    }
  return worst;
}
} // namespace

TEST(CarriedRuns, HaveTheForcesOfTheLaw)
{
  for (const bool upright : {false, true})
    for (const double cell : {1.0, 2.0, 2.5, 4.0, 10.0}) {
      const Edge edge(150, cell, upright);
      EXPECT_LT(difference(edge, edge.rows()), 1e-13) << cell;
      EXPECT_EQ(CarriedRuns<2>(edge.points, edge.run_bonds(), edge.rows()).numbers().size(), edge.bonds.size());
    }
}

TEST(CarriedRuns, OfAnyLengthHaveTheForcesOfTheLaw)
{
  for (const Index length : {1, 3, 5, 8, 9, 17, 63, 64, 65}) {
    const Edge edge(length, 4.0, false);
    EXPECT_LT(difference(edge, edge.rows()), 1e-13) << length;
  }
}

TEST(CarriedRuns, OfManyShortSidesHaveTheForcesOfTheLaw)
{
  for (const Index side : {1, 3, 4, 40}) {
    Edge edge(90, 4.0, false);
    for (auto& bond : edge.bonds) {
      bond.run.leaves.side = bond.run.leaves.place / side;
      bond.run.leaves.place %= side;
    }
    EXPECT_LT(difference(edge, edge.rows()), 1e-13) << side;
    const CarriedRuns<2> runs(edge.points, edge.run_bonds(), edge.rows());
    EXPECT_GT(runs.numbers().size(), edge.bonds.size() * 9 / 10) << side;
  }
}

TEST(CarriedRuns, WithGapsHaveTheForcesOfTheLaw)
{
  Edge edge(100, 4.0, false);
  std::mt19937 generator(3);
  for (auto& bond : edge.bonds)
    if (generator() % 3 == 0) bond.stiffness = 0.0; // gone
  EXPECT_LT(difference(edge, edge.rows()), 1e-13);
  std::vector<Edge::Bond> few;
  for (const auto& bond : edge.bonds)
    if (bond.run.leaves.place % 7 != 2 && bond.stiffness > 0.0) {
      few.push_back(bond);
      few.back().run.number = few.size() - 1;
    }
  edge.bonds = few;
  EXPECT_LT(difference(edge, edge.rows()), 1e-13);
}

TEST(CarriedRuns, AddToOwnedRowsOnly)
{
  const Edge edge(70, 4.0, false);
  for (const Index owned : {40, 3 * 70 - 5, 3 * 70 + 4}) EXPECT_LT(difference(edge, owned), 1e-13) << owned;
}

TEST(CarriedRuns, SeeABondThatPassesItsLimitUnlessItIsGoneOrNeverFails)
{
  Edge edge(80, 4.0, false);
  std::vector<double> u(static_cast<std::size_t>(2 * edge.rows()), 0.0), r = u;
  const std::size_t lifted = 2 * 33 + 1; // of the first row, whose bonds straight down stretch by 0.01 / 0.25 there
  u[lifted] = 0.01;
  const auto seen = [&](double stretch, bool finite, bool no_fail, bool gone) {
    for (auto& bond : edge.bonds) bond.run.no_fail = no_fail && bond.run.row == 33;
    CarriedRuns<2> runs(edge.points, edge.run_bonds(), edge.rows());
    runs.set_stiffness([&](std::size_t number) { return gone && edge.bonds[number].run.row == 33 ? 0.0 : 1.0; });
    runs.set_limits([&](Index, double) { return finite ? stretch * (2.0 + stretch) : stretch; });
    bool any = false;
    for (const Processor processor : processors()) any = runs.add_forces(processor, finite, u, r);
    return any;
  };
  for (const bool finite : {true, false}) {
    EXPECT_TRUE(seen(0.0399999, finite, false, false));
    EXPECT_FALSE(seen(0.0400001, finite, false, false));
    EXPECT_FALSE(seen(0.0399999, finite, true, false));
    EXPECT_FALSE(seen(0.0399999, finite, false, true));
  }
}
} // namespace pdx::test::carried_runs
