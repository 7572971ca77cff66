#include "pdx/adapt/watch_kernel.hpp"

#include "pdx/base/node_lanes.hpp"

#include <algorithm>

namespace pdx::adapt {
namespace {
/// Nodes are arrays of two numbers T: doubles, or lanes of them.
template <class T, class Nodes> PDX_INLINE void square_of_gradient(const WatchRun& cells, const Nodes& at, T& square)
{
  T apart[4]; // along the edges from corner a to the next, squared
  PDX_UNROLL
  for (int a = 0; a < 4; ++a) {
    const T x = at[(a + 1) % 4][0] - at[a][0], y = at[(a + 1) % 4][1] - at[a][1];
    apart[a] = x * x + y * y;
  }
  square = (apart[0] > apart[2] ? apart[0] : apart[2]) * cells.along +
           (apart[1] > apart[3] ? apart[1] : apart[3]) * cells.across;
}

struct FindSuspicious {
  std::span<const WatchRun> runs;
  const double* u;
  std::vector<std::size_t>& found;

  template <int W> PDX_INLINE void run() const
  {
    std::size_t first = 0;
    for (const WatchRun& cells : runs) {
      if (cells.cells > W / 4)
        for (Index k = 0; k < cells.cells; k += W) look<W>(cells, k, first);
      else
        for (Index k = 0; k < cells.cells; ++k) look_at_one(cells, k, first);
      first += static_cast<std::size_t>(cells.cells);
    }
  }

  template <int W> PDX_INLINE void look(const WatchRun& cells, Index k, std::size_t first) const
  {
    const Index count = cells.cells - k;
    NodeLanes<W, 2> at[4];
    PDX_UNROLL
    for (int a = 0; a < 4; ++a) load_nodes<W>(u + 2 * (cells.rows[static_cast<std::size_t>(a)] + k), count, at[a]);
    Lanes<W> square;
    square_of_gradient(cells, at, square);
    const auto calm = square < cells.limit;
    if (!any_true(~calm)) return;
    for (Index l = 0; l < std::min<Index>(W, count); ++l)
      if (!calm[l]) found.push_back(first + static_cast<std::size_t>(k + l));
  }

  PDX_INLINE void look_at_one(const WatchRun& cells, Index k, std::size_t first) const
  {
    const double* at[4];
    for (std::size_t a = 0; a < 4; ++a) at[a] = u + 2 * (cells.rows[a] + k);
    double square = 0.0;
    square_of_gradient(cells, at, square);
    if (square >= cells.limit) found.push_back(first + static_cast<std::size_t>(k));
  }
};
} // namespace

void find_suspicious(Processor processor, std::span<const WatchRun> runs, std::span<const double> u,
                     std::vector<std::size_t>& found)
{
  found.clear();
  run_on(processor, FindSuspicious{runs, u.data(), found});
}
} // namespace pdx::adapt
