#include "pdx/solve/keep_rule.hpp"
#include "pdx/solve/load_path.hpp"

#include <gtest/gtest.h>
#include <vector>

using pdx::solve::KeepRule;
using pdx::solve::LoadPath;

TEST(LoadPath, EqualIncrementsEndAtOne)
{
  LoadPath path(3, 6);
  std::vector<double> loads;
  for (; !path.done(); path.advance()) loads.push_back(path.target());
  EXPECT_EQ(loads, (std::vector<double>{1.0 / 3, 2.0 / 3, 1.0}));
}

TEST(LoadPath, HalvesGrowBackAndHitTheEndsOfIncrements)
{
  LoadPath path(2, 3);
  std::vector<double> loads;
  const auto reach = [&] {
    loads.push_back(path.target());
    path.advance();
  };
  EXPECT_TRUE(path.halve());
  EXPECT_TRUE(path.halve());
  EXPECT_EQ(path.size(), 0.125);
  while (!path.done()) reach();
  EXPECT_EQ(loads, (std::vector<double>{0.125, 0.25, 0.5, 1.0})); // 1/8 twice, then 1/4, then the whole increment
}

TEST(LoadPath, AHalfWaitsForItsPlaceBeforeItGrows)
{
  LoadPath path(1, 3);
  path.halve();
  path.advance(); // 1/2
  path.halve();   // of the second half
  path.halve();
  std::vector<double> loads;
  for (; !path.done(); path.advance()) loads.push_back(path.target());
  EXPECT_EQ(loads, (std::vector<double>{0.625, 0.75, 1.0}));
}

TEST(LoadPath, SmallestPartIsNotHalved)
{
  LoadPath path(5, 2);
  EXPECT_TRUE(path.halve());
  EXPECT_TRUE(path.halve());
  EXPECT_FALSE(path.halve());
  EXPECT_EQ(path.size(), 0.05);
  LoadPath whole(5, 0);
  EXPECT_FALSE(whole.halve());
}

TEST(KeepRule, BuildsAtFirstAndWhenIterationsGrow)
{
  KeepRule rule(1.3);
  EXPECT_TRUE(rule.wants_build());
  rule.built();
  rule.solved(10, 10.0);
  rule.solved(15, 10.0); // 1.3 x 10 + 2
  EXPECT_FALSE(rule.wants_build());
  rule.solved(16, 10.0);
  EXPECT_TRUE(rule.wants_build());
}

TEST(KeepRule, ComparesSolvesOfDifferentDepthInProportion)
{
  KeepRule rule(1.3);
  rule.built();
  rule.solved(5, 5.0);   // one iteration for each decade
  rule.solved(15, 10.0); // 1.3 x 10 + 2
  EXPECT_FALSE(rule.wants_build());
  rule.solved(9, 5.0); // above 1.3 x 5 + 2
  EXPECT_TRUE(rule.wants_build());
}
