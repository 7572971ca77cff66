#include "pdx/io/agree.hpp"

#include "pdx/base/events.hpp"
#include "pdx/io/summary.hpp"

#include <gtest/gtest.h>
#include <petscsys.h>

namespace {
int rank_and_size(int& size)
{
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  return rank;
}
} // namespace

TEST(Agree, EveryRankHearsTheFirstComplaint)
{
  int size = 0;
  const int rank = rank_and_size(size);
  EXPECT_EQ(pdx::io::first_message(PETSC_COMM_WORLD, ""), "");
  const std::string mine = rank == size - 1 ? "disk full on the last rank" : "";
  EXPECT_EQ(pdx::io::first_message(PETSC_COMM_WORLD, mine), "disk full on the last rank");
  EXPECT_EQ(pdx::io::first_message(PETSC_COMM_WORLD, "rank " + std::to_string(rank)), "rank 0");
}

TEST(GatherEventCounts, TakesTheBusiestRank)
{
  int size = 0;
  const int rank = rank_and_size(size);
  pdx::Event event("io_test_of_counts");
  for (int i = 0; i < 3 * rank; ++i) const pdx::Timed timed(event); // rank 0 never enters
  const auto counts = pdx::io::gather_event_counts(PETSC_COMM_WORLD);
  if (size == 1)
    EXPECT_EQ(counts.count("io_test_of_counts"), 0u);
  else
    EXPECT_EQ(counts.at("io_test_of_counts"), 3 * (size - 1));
}
