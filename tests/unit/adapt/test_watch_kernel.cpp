#include "pdx/adapt/watch_kernel.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace pdx;
using adapt::WatchRun;

namespace {
/// Unit cells on two lines of nodes, in runs of the lengths given.
std::vector<WatchRun> unit_cells(std::initializer_list<Index> lengths, double limit)
{
  Index across = 0;
  for (const Index cells : lengths) across += cells + 1;
  std::vector<WatchRun> runs;
  Index first = 0;
  for (const Index cells : lengths) {
    runs.push_back({{first, first + 1, across + first + 1, across + first}, cells, 1.0, 1.0, limit});
    first += cells + 1;
  }
  return runs;
}
} // namespace

TEST(WatchKernel, FindsWhatAPlainLoopFindsOnEachProcessor)
{
  const std::vector<WatchRun> runs = unit_cells({1, 37, 8, 3, 2, 16}, 2.2);
  Index nodes = 0, cells = 0;
  for (const WatchRun& run : runs) nodes += 2 * (run.cells + 1), cells += run.cells;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  std::vector<double> u(static_cast<std::size_t>(2 * nodes));
  for (double& x : u) x = any(random);

  std::vector<std::size_t> expected;
  std::size_t cell = 0;
  for (const WatchRun& run : runs)
    for (Index k = 0; k < run.cells; ++k, ++cell) {
      const auto square = [&](std::size_t a, std::size_t b) {
        const auto p = static_cast<std::size_t>(2 * (run.rows[a] + k)),
                   q = static_cast<std::size_t>(2 * (run.rows[b] + k));
        return std::pow(u[p] - u[q], 2) + std::pow(u[p + 1] - u[q + 1], 2);
      };
      const double along = std::max(square(0, 1), square(3, 2)), across = std::max(square(0, 3), square(1, 2));
      if (along + across >= run.limit) expected.push_back(cell);
    }
  ASSERT_GT(expected.size(), 10U);
  ASSERT_LT(expected.size() + 10U, static_cast<std::size_t>(cells));
  for (const Processor processor : {Processor::any, Processor::avx2, Processor::avx512}) {
    if (processor > this_processor()) continue;
    std::vector<std::size_t> found{7};
    find_suspicious(processor, runs, u, found);
    EXPECT_EQ(found, expected);
  }
}
