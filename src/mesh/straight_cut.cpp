#include "pdx/mesh/straight_cut.hpp"

#include "pdx/geom/box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pdx::mesh {
namespace straight {
constexpr double kSameLine = 1e-6; // of the mean distance of cells: middles on one line

class Bisection {
public:
  explicit Bisection(const PlacedCells& cells) : cells_(cells), part_(cells.weight.size(), 0) {}

  std::vector<int> run(int parts)
  {
    std::vector<Index> all(part_.size());
    std::iota(all.begin(), all.end(), 0);
    split(all, 0, parts);
    return std::move(part_);
  }

private:
  const Vector<2>& at(Index c) const { return cells_.middle[static_cast<std::size_t>(c)]; }
  double weight(Index c) const { return cells_.weight[static_cast<std::size_t>(c)]; }

  /// How many of the cells in order go to the lower side: as near to `share` of the weight as a line comes.
  std::size_t place_of_cut(std::span<const Index> cells, Eigen::Index axis, double share, double line) const
  {
    const double total =
        std::accumulate(cells.begin(), cells.end(), 0.0, [this](double sum, Index c) { return sum + weight(c); });
    std::size_t best = 0;
    double before = 0.0, least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 1; k < cells.size(); ++k) {
      before += weight(cells[k - 1]);
      if (at(cells[k])[axis] - at(cells[k - 1])[axis] < line) continue;
      if (const double gap = std::abs(before - share * total); gap < (1.0 - kSameLine) * least) {
        least = gap;
        best = k;
      }
    }
    return best;
  }

  void split(std::span<Index> cells, int first, int parts)
  {
    if (parts == 1 || cells.size() < 2) {
      for (const Index c : cells) part_[static_cast<std::size_t>(c)] = first;
      return;
    }
    geom::Box<2> around{at(cells[0]), at(cells[0])};
    for (const Index c : cells) {
      around.lower = around.lower.cwiseMin(at(c));
      around.upper = around.upper.cwiseMax(at(c));
    }
    const Vector<2> size = around.size();
    const double line = kSameLine * size.maxCoeff() / std::sqrt(static_cast<double>(cells.size()));
    const Eigen::Index axis = size[1] > size[0] + line ? 1 : 0;
    std::ranges::sort(cells,
                      [&](Index a, Index b) { return at(a)[axis] != at(b)[axis] ? at(a)[axis] < at(b)[axis] : a < b; });
    const int below = parts / 2;
    const std::size_t cut = place_of_cut(cells, axis, static_cast<double>(below) / parts, line);
    split(cells.subspan(0, cut), first, below);
    split(cells.subspan(cut), first + below, parts - below);
  }

  PlacedCells cells_;
  std::vector<int> part_;
};
} // namespace straight

std::vector<int> straight_cut(const PlacedCells& cells, int parts) { return straight::Bisection(cells).run(parts); }

double busiest_window(const PlacedCells& cells, std::span<const int> part, int parts)
{
  const std::size_t count = part.size();
  const double far = std::numeric_limits<double>::max();
  std::vector<geom::Box<2>> around(static_cast<std::size_t>(parts),
                                   {Vector<2>::Constant(far), Vector<2>::Constant(-far)});
  geom::Box<2> all = around[0];
  for (std::size_t c = 0; c < count; ++c)
    for (geom::Box<2>* box : {&around[static_cast<std::size_t>(part[c])], &all}) {
      box->lower = box->lower.cwiseMin(cells.middle[c]);
      box->upper = box->upper.cwiseMax(cells.middle[c]);
    }
  const double cell = std::sqrt(all.size().prod() / static_cast<double>(count));
  std::vector<std::size_t> along(count); // by x: a box looks at the cells of its own width only
  std::iota(along.begin(), along.end(), 0U);
  const auto x_of = [&cells](std::size_t c) { return cells.middle[c][0]; };
  std::ranges::sort(along, {}, x_of);
  const double margin = 1.5 * cell;
  std::vector<double> window(around.size(), 0.0);
  for (std::size_t p = 0; p < around.size(); ++p) {
    const auto first = std::ranges::lower_bound(along, around[p].lower[0] - 2.0 * margin, {}, x_of);
    const auto end = std::ranges::upper_bound(along, around[p].upper[0] + 2.0 * margin, {}, x_of);
    for (auto c = first; c < end; ++c)
      if (around[p].contains(cells.middle[*c], margin)) window[p] += cells.weight[*c];
  }
  return *std::ranges::max_element(window);
}
} // namespace pdx::mesh
