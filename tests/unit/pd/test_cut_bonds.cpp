#include "pdx/pd/breaker.hpp"
#include "window.hpp"

#include <gtest/gtest.h>

namespace pdx::test::cut_bonds {
namespace {
using crack::CrackSet;

template <int Dim> std::int64_t cut(Window<Dim>& window, const CrackSet& cracks)
{
  return pd::cut_bonds<Dim>(cracks, {window.sites, {}, window.sites.count}, window.stencil, window.runs,
                            {window.words[0].data(), window.words[1].data()});
}
template <int Dim> Vector<Dim> place(const Window<Dim>& window, Index row)
{
  return window.sites.point(window.sites.site(window.particles[row]));
}
template <int Dim> bool has_bond(const Window<Dim>& window, const typename Window<Dim>::Pair& pair)
{
  const std::ptrdiff_t i = window.particles[pair.i], jump = window.particles[pair.j] - i;
  for (std::size_t h = 0; h < window.arms.size(); ++h)
    if (window.arms[h].jump == jump) return (window.words[h / 64][i] >> h % 64 & 1u) != 0;
  return false;
}
CrackSet far_reaching(const Vector<2>& a, const Vector<2>& b)
{
  return CrackSet({{a, b}}, geom::Box<2>{{-1.0, -1.0}, {1.0, 1.0}});
}

// m = 3 conical: arms up to (2, 2). Through a row of n particles pass, upwards, n bonds (0, 1), n (0, 2) of either of
// two rows, and so on; in the middle of a wide plate per column 1 + 2 (1, 1) + 2 (2, 1) = 5 of height 1 and, twice
// over, 1 + 2 (1, 2) + 2 (2, 2) = 5 of height 2: 15 per column.
TEST(CutBonds, BetweenRowsCutsWhatCrosses)
{
  Window<2> window({40, 8}, {.ratio = 3.0});
  const double y = (window.stencil.reach + 4) * window.kDx; // between rows 3 and 4
  const Window<2> before = window;
  const std::int64_t n = cut(window, far_reaching({0.0, y}, {1e-1, y}));
  // At each end of a row the |step_x| outermost bonds are missing, as in 40 - |step_x|.
  EXPECT_EQ(n, 40 + 2 * 39 + 2 * 38 + 2 * (40 + 2 * 39 + 2 * 38));
  for (const auto& pair : before.pairs) {
    const bool crosses = (place(window, pair.i).y() - y) * (place(window, pair.j).y() - y) < 0.0;
    EXPECT_EQ(has_bond(window, pair), !crosses);
  }
  EXPECT_EQ(cut(window, far_reaching({0.0, y}, {1e-1, y})), 0);
}

TEST(CutBonds, AlongARowLeavesTheRowOnTheCracksLeft)
{
  Window<2> window({20, 8}, {.ratio = 3.0});
  const double y = (window.stencil.reach + 3.5) * window.kDx; // through particles of row 3
  const Window<2> before = window;
  cut(window, far_reaching({0.0, y}, {1e-1, y}));
  for (const auto& pair : before.pairs) {
    const bool left_i = place(window, pair.i).y() > y - 0.1 * window.kDx;
    const bool left_j = place(window, pair.j).y() > y - 0.1 * window.kDx;
    EXPECT_EQ(has_bond(window, pair), left_i == left_j);
  }
}

TEST(CutBonds, InSpaceTheCrackReachesThroughTheThickness)
{
  Window<3> window({10, 8, 6}, {.ratio = 2.3});
  const double y = (window.stencil.reach + 4) * window.kDx, tip = (window.stencil.reach + 5) * window.kDx;
  const Window<3> before = window;
  const std::int64_t n = cut(window, CrackSet({{{0.0, y}, {tip, y}}}, geom::Box<2>{{0.0, 0.0}, {1.0, 1.0}}));
  std::int64_t gone = 0;
  for (const auto& pair : before.pairs) {
    const Vector<3> a = place(window, pair.i), b = place(window, pair.j);
    const bool crosses = (a.y() - y) * (b.y() - y) < 0.0;
    const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (crosses && std::abs(x - tip) < 1e-3 * window.kDx) continue; // through the front: to the last bit
    EXPECT_EQ(has_bond(window, pair), !(crosses && x < tip));
  }
  for (const auto& pair : before.pairs) gone += !has_bond(window, pair);
  EXPECT_EQ(n, gone);
  EXPECT_GT(n, 500);
}

TEST(CutBonds, OfSeveralCracksABondIsCutOnce)
{
  Window<2> window({20, 8}, {.ratio = 3.0});
  const double y = (window.stencil.reach + 4) * window.kDx;
  Window<2> other = window;
  const crack::Polyline line{{0.0, y}, {1e-1, y}}, beside{{0.0, y + 1e-7}, {1e-1, y + 1e-7}}; // between the same rows
  const geom::Box<2> body{{-1.0, -1.0}, {1.0, 1.0}};
  EXPECT_EQ(cut(window, CrackSet({line, beside}, body)), cut(other, CrackSet({line}, body)));
}
} // namespace
} // namespace pdx::test::cut_bonds
