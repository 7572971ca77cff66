#include "pdx/track/crack_tracker.hpp"

#include "pdx/base/petsc.hpp"
#include "pdx/pd/particles.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace pdx::test::crack_tracker {
namespace {
const geom::Lattice<2> kLattice{{0.0, -10.0}, 1.0, {60, 20}};
const track::TreeGround kGround{kLattice, 3.0, {{}, 60}}; // the name of a site is its number
const geom::Box<2> kBody{{0.0, -10.0}, {60.0, 10.0}};
constexpr double kSpeed = 3.0, kHorizon = 3.0;

/// Damage of a crack from the left edge whose tip is at x: a ramp about a unit behind it, less in farther rows.
double damage_at(const Vector<2>& at, double tip)
{
  const double behind = std::clamp((tip - at.x()) / 4.0, 0.0, 1.0);
  return behind * std::max(0.0, 0.5 - 0.08 * std::abs(at.y()));
}

/// Particles of this rank: every so many rows, so that the crack runs along a border of ranks.
std::vector<pd::Particle> particles(MPI_Comm comm)
{
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &ranks);
  std::vector<pd::Particle> mine;
  for (Index site = 0; site < static_cast<Index>(kLattice.total()); ++site)
    if (kLattice.site(site)[1] * ranks / kLattice.count[1] == rank)
      mine.push_back({0, site, 0, kLattice.point(kLattice.site(site))});
  return mine;
}

void look(track::CrackTracker& tracker, double time, std::span<const pd::Particle> mine, std::span<const double> damage)
{
  tracker.look(time, damage, [&](std::size_t k) { return static_cast<std::uint64_t>(mine[k].site); });
}

track::CrackTracker fresh(MPI_Comm comm)
{
  const crack::CrackSet cracks({{{0.0, 0.0}, {10.0, 0.0}}}, kBody);
  return {comm, cracks.tips(), {kGround}, 0.35};
}

/// Looks at steps up to 20; at step `restart` a new tracker goes on from the state of the first.
track::CrackTracker run(MPI_Comm comm, int restart = -1)
{
  track::CrackTracker tracker = fresh(comm);
  const std::vector<pd::Particle> mine = particles(comm);
  for (int step = 0; step <= 20; ++step) {
    if (step == restart) {
      track::CrackTracker other = fresh(comm);
      other.resume(tracker.state());
      tracker = std::move(other);
    }
    const double time = 0.7 * step, tip = 10.0 + kSpeed * std::max(0.0, time - 2.0);
    std::vector<double> damage;
    for (const pd::Particle& particle : mine) damage.push_back(damage_at(particle.x, tip));
    look(tracker, time, mine, damage);
  }
  return tracker;
}
} // namespace

TEST(CrackTracker, SeesWhereTheCrackIsAndHowFastItRuns)
{
  const auto tracker = run(PETSC_COMM_WORLD);
  const auto tips = tracker.tree().tips();
  ASSERT_EQ(tips.size(), 1u);
  EXPECT_NEAR(tips[0].at.x(), 10.0 + kSpeed * 12.0, kHorizon + 1.0);
  EXPECT_NEAR(tips[0].at.y(), 0.0, 1e-12);
  EXPECT_NEAR(tracker.now().speed, kSpeed, 0.01 * kSpeed); // whatever the lattice and the looks
  EXPECT_LT(tracker.largest_speed(), 1.15 * kSpeed);       // it starts between two looks, 2 spacings apart
  EXPECT_GT(*tracker.tree().start_time(), 2.0 - 0.7);      // a look
  EXPECT_LT(*tracker.tree().start_time(), 2.0 + 1.0 / kSpeed);
}

TEST(CrackTracker, SeesTheSameOnAnyNumberOfRanks)
{
  const auto here = run(PETSC_COMM_WORLD), alone = run(PETSC_COMM_SELF);
  const auto mine = here.tree().tips(), theirs = alone.tree().tips();
  ASSERT_EQ(mine.size(), theirs.size());
  EXPECT_EQ(mine[0].at, theirs[0].at);
  EXPECT_EQ(mine[0].length, theirs[0].length);
  ASSERT_EQ(mine[0].path.size(), theirs[0].path.size());
  for (std::size_t k = 0; k < mine[0].path.size(); ++k) EXPECT_EQ(mine[0].path[k].time, theirs[0].path[k].time);
  EXPECT_EQ(here.largest_speed(), alone.largest_speed());
}

TEST(CrackTracker, GoesOnFromAStateToTheLastBit)
{
  const auto whole = run(PETSC_COMM_WORLD), resumed = run(PETSC_COMM_WORLD, 9);
  const auto mine = resumed.tree().tips(), theirs = whole.tree().tips();
  ASSERT_EQ(mine.size(), theirs.size());
  EXPECT_EQ(mine[0].length, theirs[0].length);
  EXPECT_EQ(resumed.now().speed, whole.now().speed);
  EXPECT_EQ(resumed.largest_speed(), whole.largest_speed());
  ASSERT_EQ(mine[0].path.size(), theirs[0].path.size());
  for (std::size_t k = 0; k < mine[0].path.size(); ++k) EXPECT_EQ(mine[0].path[k].time, theirs[0].path[k].time);
}

TEST(CrackTracker, WhatWasBrokenFromTheStartIsNoGrowth)
{
  const crack::CrackSet cracks({{{0.0, 0.0}, {10.0, 0.0}}}, kBody);
  track::CrackTracker tracker(PETSC_COMM_WORLD, cracks.tips(), {kGround}, 0.35);
  const std::vector<pd::Particle> mine = particles(PETSC_COMM_WORLD);
  std::vector<double> damage;
  for (const pd::Particle& particle : mine) damage.push_back(damage_at(particle.x, 10.0));
  look(tracker, 0.0, mine, damage);
  look(tracker, 1.0, mine, damage);
  tracker.nothing_new(2.0);
  EXPECT_EQ(tracker.now().grown, 0.0);
  EXPECT_EQ(tracker.now().speed, 0.0);
  EXPECT_EQ(tracker.now().tips, 1);
  EXPECT_FALSE(tracker.tree().start_time());
}
} // namespace pdx::test::crack_tracker
