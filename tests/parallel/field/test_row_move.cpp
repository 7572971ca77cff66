#include "pdx/field/row_move.hpp"
#include "support/ranks.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

using namespace pdx;
using field::RowName;
using pdx::test::rank;
using pdx::test::ranks;

namespace {
constexpr std::uint64_t kThings = 500;

RowName name_of(std::uint64_t thing)
{
  switch (thing % 3) {
  case 0:
    return RowName::node(static_cast<Index>(thing));
  case 1:
    return RowName::set(static_cast<Index>(thing), static_cast<int>(thing % 7));
  default:
    return RowName::particle(thing << 40);
  }
}

/// The things that a shuffle gives this rank: every one to exactly one rank.
std::vector<std::uint64_t> dealt(unsigned seed)
{
  std::mt19937 chance(seed);
  std::vector<std::uint64_t> mine;
  for (std::uint64_t thing = 0; thing < kThings; ++thing)
    if (static_cast<int>(chance() % static_cast<unsigned>(ranks())) == rank()) mine.push_back(thing);
  std::shuffle(mine.begin(), mine.end(), chance);
  return mine;
}

std::vector<RowName> names_of(const std::vector<std::uint64_t>& things)
{
  std::vector<RowName> names;
  for (const std::uint64_t thing : things) names.push_back(name_of(thing));
  return names;
}
} // namespace

TEST(RowMove, CarriesValuesToWhateverRankWantsThem)
{
  const std::vector<std::uint64_t> before = dealt(3), after = dealt(4);
  const field::RowMove move(PETSC_COMM_WORLD, names_of(before), names_of(after));
  std::vector<double> values;
  std::vector<std::uint64_t> words;
  for (const std::uint64_t thing : before) {
    values.insert(values.end(), {static_cast<double>(thing), -0.5 * static_cast<double>(thing)});
    words.push_back(~thing);
  }
  const std::vector<double> carried = move.carry(values, 2);
  const std::vector<std::uint64_t> carried_words = move.carry(words, 1);
  EXPECT_TRUE(move.unique());
  EXPECT_TRUE(move.fresh().empty());
  ASSERT_EQ(carried.size(), 2 * after.size());
  for (std::size_t k = 0; k < after.size(); ++k) {
    EXPECT_EQ(carried[2 * k], static_cast<double>(after[k]));
    EXPECT_EQ(carried[2 * k + 1], -0.5 * static_cast<double>(after[k]));
    EXPECT_EQ(carried_words[k], ~after[k]);
  }
}

TEST(RowMove, TellsWhatIsFreshAndLendsAsOftenAsAsked)
{
  // Only multiples of 5 are there; every rank wants all of them, and the things between.
  std::vector<RowName> from{RowName()};
  std::vector<double> values{-1.0};
  for (std::uint64_t thing = 0; thing < kThings; thing += 5)
    if (static_cast<int>(thing / 5) % ranks() == rank()) {
      from.push_back(name_of(thing));
      values.push_back(static_cast<double>(thing) + 1.0);
    }
  std::vector<RowName> to;
  for (std::uint64_t thing = 0; thing < kThings; ++thing) to.push_back(name_of(thing));
  const field::RowMove move(PETSC_COMM_WORLD, from, to);
  const std::vector<double> carried = move.carry(values, 1);
  EXPECT_EQ(move.fresh().size(), kThings - kThings / 5);
  for (std::uint64_t thing = 0; thing < kThings; ++thing)
    EXPECT_EQ(carried[thing], thing % 5 ? 0.0 : static_cast<double>(thing) + 1.0);
  for (const Index k : move.fresh()) EXPECT_NE(k % 5, 0);
}

TEST(RowMove, SeesANameThatComesTwice)
{
  std::vector<RowName> from = names_of(dealt(5));
  if (rank() == ranks() - 1) from.push_back(name_of(17));
  EXPECT_FALSE(field::RowMove(PETSC_COMM_WORLD, from, {}).unique());
}

/// Most stay where they are, some change rank, some come, some go.
TEST(RowMove, FindsWhatIsWantedOnceHereOrElsewhere)
{
  for (const unsigned seed : {3u, 4u}) { // the same ranks, and others
    std::vector<std::uint64_t> before = dealt(3), after = dealt(seed);
    std::erase_if(before, [](std::uint64_t thing) { return thing % 11 == 0; });
    std::erase_if(after, [](std::uint64_t thing) { return thing % 7 == 0; });
    const std::vector<RowName> from = names_of(before), to = names_of(after);
    const field::RowMove move(PETSC_COMM_WORLD, from, to, field::RowMove::Wanted::once);
    std::vector<std::uint64_t> words;
    for (const std::uint64_t thing : before) words.push_back(~thing);
    const std::vector<std::uint64_t> carried = move.carry(words, 1);
    std::vector<Index> fresh, left;
    ASSERT_EQ(carried.size(), after.size());
    for (std::size_t k = 0; k < after.size(); ++k) {
      EXPECT_EQ(carried[k], after[k] % 11 ? ~after[k] : 0);
      if (after[k] % 11 == 0) fresh.push_back(static_cast<Index>(k));
    }
    for (std::size_t k = 0; k < before.size(); ++k)
      if (before[k] % 7 == 0) left.push_back(static_cast<Index>(k));
    EXPECT_TRUE(std::ranges::equal(move.fresh(), fresh));
    EXPECT_EQ(move.left_behind(), left);
  }
}
