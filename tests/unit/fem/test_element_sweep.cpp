#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/fem/element_sweep.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>

using namespace pdx;
using fem::ElementSweep;
using law::Kinematics;

namespace element_sweeps {
const law::Elastic kPlate{70e9, 0.3, law::Plane::stress, 2e-3};
const law::Elastic kThick{70e9, 0.2, law::Plane::strain, 2e-3};
constexpr double kWidth = 1.3e-2, kHeight = 0.9e-2;

std::vector<Processor> processors()
{
  std::vector<Processor> list;
  for (const Processor p : {Processor::any, Processor::avx2, Processor::avx512})
    if (p <= this_processor()) list.push_back(p);
  return list;
}

/// A grid of elements that may be skewed, and how its nodes are numbered.
struct Grid {
  Index nx, ny;
  double skew = 0.0; ///< corners are shifted by up to so much of a side
  std::vector<ElementSweep::Element> elements;
  std::vector<Vector<2>> points; ///< by row
  std::vector<double> u;         ///< strains of a few per cent

  Grid(Index x, Index y, double by = 0.0) : nx(x), ny(y), skew(by)
  {
    std::vector<Index> in_order(static_cast<std::size_t>((nx + 1) * (ny + 1)));
    std::iota(in_order.begin(), in_order.end(), 0);
    number(in_order);
  }
  /// @param row of node (i, j) at j * (nx + 1) + i
  void number(const std::vector<Index>& row)
  {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> random(-1.0, 1.0);
    elements.clear();
    points.resize(row.size());
    u.resize(2 * row.size());
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i) {
        const auto n = static_cast<std::size_t>(row[static_cast<std::size_t>(j * (nx + 1) + i)]);
        points[n] << kWidth * (i + skew * random(generator)), kHeight * (j + skew * random(generator));
        for (std::size_t d = 0; d < 2; ++d) u[2 * n + d] = 0.03 * kHeight * random(generator);
      }
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        const auto at = [&](Index a, Index b) { return row[static_cast<std::size_t>((j + b) * (nx + 1) + i + a)]; };
        const std::array<Index, 4> rows{at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
        fem::Corners corners;
        std::ranges::transform(rows, corners.begin(), [&](Index n) { return points[static_cast<std::size_t>(n)]; });
        elements.push_back({corners, rows, true});
      }
  }
};

fem::ElementVector displacement(const ElementSweep::Element& element, std::span<const double> u)
{
  fem::ElementVector d;
  for (int a = 0; a < 4; ++a) {
    const auto row = static_cast<std::size_t>(element.rows[static_cast<std::size_t>(a)]);
    d.segment<2>(2 * a) << u[2 * row], u[2 * row + 1];
  }
  return d;
}

/// Compares with one element after the other, on rows below `owned`.
void expect_the_plain_kernels_answers(const Grid& grid, const law::Elastic& law, Index owned)
{
  for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite}) {
    std::vector<double> expected(2 * static_cast<std::size_t>(owned), 0.0);
    double energy = 0.0, largest = 0.0;
    for (const auto& element : grid.elements) {
      const auto d = displacement(element, grid.u);
      const auto force = fem::element_force(element.corners, d, law, kinematics);
      if (element.counted) energy += fem::element_energy(element.corners, d, law, kinematics);
      for (std::size_t i = 0; i < 8; ++i)
        if (const Index row = element.rows[i / 2]; row < owned)
          expected[2 * static_cast<std::size_t>(row) + i % 2] += force[static_cast<Eigen::Index>(i)];
    }
    for (const double f : expected) largest = std::max(largest, std::abs(f));
    for (const Processor processor : processors()) {
      const ElementSweep sweep(law, kinematics, grid.elements, owned, processor);
      std::vector<double> r(expected.size(), 0.0);
      sweep.add_force(grid.u, r);
      for (std::size_t i = 0; i < r.size(); ++i) ASSERT_NEAR(r[i], expected[i], 1e-13 * largest) << "component " << i;
      EXPECT_NEAR(sweep.energy(grid.u), energy, 1e-13 * energy);
    }
  }
}
Index rows_of(const Grid& grid) { return static_cast<Index>(grid.points.size()); }
Index in_runs(const Grid& grid, Index owned, Processor processor = Processor::any)
{
  return ElementSweep(kPlate, Kinematics::finite, grid.elements, owned, processor).in_runs();
}

TEST(ElementSweep, RectanglesInRunsOfAnyLengthPullLikeThePlainKernel)
{
  for (Index n = 1; n <= 17; ++n)
    for (const Index lines : {1, 3}) {
      SCOPED_TRACE(n);
      const Grid grid(n, lines);
      expect_the_plain_kernels_answers(grid, n % 2 ? kPlate : kThick, rows_of(grid));
      EXPECT_EQ(in_runs(grid, rows_of(grid)), n > 1 ? n * lines : 0);
    }
}

TEST(ElementSweep, SkewedElementsPullLikeThePlainKernel)
{
  for (Index n = 1; n <= 17; ++n) {
    SCOPED_TRACE(n);
    const Grid grid(n, 2, 0.2);
    expect_the_plain_kernels_answers(grid, kPlate, rows_of(grid));
    EXPECT_EQ(in_runs(grid, rows_of(grid)), 0);
  }
}

TEST(ElementSweep, RunsGoWhereverRowsCountUpwards)
{
  constexpr Index nx = 11, ny = 10;
  const auto numbered = [](auto&& row_of) {
    std::vector<Index> row;
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i) row.push_back(row_of(i, j));
    Grid grid(nx, ny);
    grid.number(row);
    return grid;
  };
  const Grid grids[] = {
      numbered([](Index i, Index j) { return j * (nx + 1) + (nx - i); }),         // to the left
      numbered([](Index i, Index j) { return (ny - j) * (nx + 1) + i; }),         // from the top
      numbered([](Index i, Index j) { return i * (ny + 1) + j; }),                // upwards
      numbered([](Index i, Index j) { return (nx - i) * (ny + 1) + (ny - j); })}; // down, from the right
  for (const Grid& grid : grids) {
    expect_the_plain_kernels_answers(grid, kPlate, rows_of(grid));
    EXPECT_EQ(in_runs(grid, rows_of(grid)), nx * ny);
  }
  std::vector<Index> row(static_cast<std::size_t>((nx + 1) * (ny + 1)));
  std::iota(row.begin(), row.end(), 0);
  std::shuffle(row.begin(), row.end(), std::mt19937(3));
  Grid shuffled(nx, ny);
  shuffled.number(row);
  expect_the_plain_kernels_answers(shuffled, kPlate, rows_of(shuffled));
  EXPECT_LT(in_runs(shuffled, rows_of(shuffled)), nx * ny / 10);
}

TEST(ElementSweep, ElementsThatAreMissingInterruptRuns)
{
  Grid grid(19, 4);
  std::erase_if(grid.elements, [k = 0](const auto&) mutable { return k++ % 11 == 3; });
  grid.elements[20].counted = false;
  expect_the_plain_kernels_answers(grid, kPlate, rows_of(grid));
  EXPECT_GT(in_runs(grid, rows_of(grid)), 50);
}

TEST(ElementSweep, RowsOfOtherRanksAreReadAndLeftAlone)
{
  for (const double skew : {0.0, 0.2})
    for (const Index owned : {0, 1, 13, 24, 30, 36, 47}) { // in a line of twelve nodes, and at its ends
      SCOPED_TRACE(owned);
      Grid grid(11, 3, skew);
      for (std::size_t k = 16; k < grid.elements.size(); ++k) grid.elements[k].counted = false;
      expect_the_plain_kernels_answers(grid, kPlate, owned);
    }
}

TEST(ElementSweep, ElementsOfOtherSidesAreNoRun)
{
  Grid grid(12, 2);
  for (auto& element : grid.elements) // columns become wider to the right
    for (Vector<2>& x : element.corners) x.x() *= 1.0 + 0.01 * x.x() / kWidth;
  expect_the_plain_kernels_answers(grid, kPlate, rows_of(grid));
  EXPECT_EQ(in_runs(grid, rows_of(grid)), 0);
  for (auto& element : grid.elements) // a parallelogram is none either
    for (Vector<2>& x : element.corners) x.x() = 0.1 * x.y() + kWidth * std::round(x.x() / kWidth);
  expect_the_plain_kernels_answers(grid, kPlate, rows_of(grid));
  EXPECT_EQ(in_runs(grid, rows_of(grid)), 0);
}

TEST(ElementSweep, RestIsExactAndRotationCostsNothing)
{
  for (const double skew : {0.0, 0.2}) {
    Grid grid(13, 5, skew);
    const auto size_of = [&](auto&& move) {
      double largest = 0.0;
      for (std::size_t n = 0; n < grid.points.size(); ++n) {
        const Vector<2> u = move(grid.points[n]);
        grid.u[2 * n] = u.x();
        grid.u[2 * n + 1] = u.y();
      }
      for (const Processor processor : processors()) {
        std::vector<double> r(grid.u.size(), 0.0);
        ElementSweep(kPlate, Kinematics::finite, grid.elements, rows_of(grid), processor).add_force(grid.u, r);
        for (const double f : r) largest = std::max(largest, std::abs(f));
      }
      return largest;
    };
    EXPECT_EQ(size_of([](const Vector<2>&) { return Vector<2>(0.0, 0.0); }), 0.0);
    EXPECT_EQ(size_of([](const Vector<2>&) { return Vector<2>(0.25, -2.0); }), 0.0);
    const double c = std::cos(0.7), s = std::sin(0.7), scale = kPlate.young * kPlate.thickness * kWidth;
    EXPECT_LT(size_of([&](const Vector<2>& x) {
                return Vector<2>((c - 1) * x.x() - s * x.y(), s * x.x() + (c - 1) * x.y());
              }),
              1e-14 * scale);
    EXPECT_GT(size_of([](const Vector<2>& x) { return Vector<2>(0.01 * x.x(), 0.0); }), 1e-3 * scale);
  }
}

TEST(ElementSweep, EvenStretchPullsTheEndsWithTheStressOfTheSolid)
{
  const double stretch = 1.2, strain = 0.5 * (stretch * stretch - 1.0);
  for (const double skew : {0.0, 0.2}) {
    Grid grid(9, 4, skew);
    for (std::size_t n = 0; n < grid.points.size(); ++n) {
      grid.u[2 * n] = (stretch - 1.0) * grid.points[n].x();
      grid.u[2 * n + 1] = 0.0;
    }
    // The rim is skewed too, so that every node's force is that of its own edges: t P n, P = diag(l C11, C12) e.
    std::vector<double> expected(grid.u.size(), 0.0);
    const auto edge = [&](Index a, Index b) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      const Vector<2> side = grid.points[j] - grid.points[i];
      for (const std::size_t n : {i, j}) {
        expected[2 * n] += 0.5 * kPlate.thickness * stretch * kPlate.c11() * strain * side.y();
        expected[2 * n + 1] -= 0.5 * kPlate.thickness * kPlate.c12() * strain * side.x();
      }
    };
    for (Index i = 0; i < 9; ++i) edge(i, i + 1), edge(40 + i + 1, 40 + i);
    for (Index j = 0; j < 4; ++j) edge(10 * j + 9, 10 * j + 19), edge(10 * j + 10, 10 * j);
    std::vector<double> r(expected.size(), 0.0);
    ElementSweep(kPlate, Kinematics::finite, grid.elements, rows_of(grid)).add_force(grid.u, r);
    const double scale = kPlate.thickness * kPlate.c11() * strain * kHeight;
    for (std::size_t i = 0; i < r.size(); ++i) EXPECT_NEAR(r[i], expected[i], 1e-13 * scale) << i;
  }
}

/// Some elements of a grid, whose nodes are numbered where they have one: those of the lowest lines are owned.
struct SomeElements {
  const Grid& grid;
  std::vector<std::uint8_t> there;
  std::vector<Index> row; ///< per node of the grid, -1 without an element
  Index owned = 0, rows = 0;

  explicit SomeElements(const Grid& of) : grid(of), there(of.elements.size(), 1) { number(); }
  void number()
  {
    row.assign(grid.points.size(), -1);
    for (std::size_t k = 0; k < there.size(); ++k)
      for (const Index n : grid.elements[k].rows)
        if (there[k]) row[static_cast<std::size_t>(n)] = 0;
    rows = 0;
    for (std::size_t n = 0; n < row.size(); ++n) {
      if (row[n] == 0) row[n] = rows++;
      if (n + 1 == 4 * (static_cast<std::size_t>(grid.nx) + 1)) owned = rows;
    }
  }
  ElementSweep::Element element(Index number) const
  {
    ElementSweep::Element of = grid.elements[static_cast<std::size_t>(number)];
    for (Index& n : of.rows) n = row[static_cast<std::size_t>(n)];
    of.counted = number % 17 > 2;
    return of;
  }
  std::vector<Index> numbers() const
  {
    std::vector<Index> all;
    for (std::size_t k = 0; k < there.size(); ++k)
      if (there[k]) all.push_back(static_cast<Index>(k));
    return all;
  }
  std::vector<double> values() const
  {
    std::vector<double> u(2 * static_cast<std::size_t>(rows));
    for (std::size_t n = 0; n < row.size(); ++n)
      if (row[n] >= 0) std::copy_n(grid.u.begin() + 2 * static_cast<std::ptrdiff_t>(n), 2, u.begin() + 2 * row[n]);
    return u;
  }
};

TEST(ElementSweep, IsToTheLastBitAsMadeAnewWhereElementsComeAndGo)
{
  std::mt19937 generator(11);
  for (const double skew : {0.0, 0.2})
    for (const Processor processor : processors()) {
      const Grid grid(23, 9, skew);
      SomeElements now(grid);
      const auto source = [&now](Index number) { return now.element(number); };
      const auto made = [&] {
        return ElementSweep(kPlate, Kinematics::finite, now.numbers(), source, now.owned, processor);
      };
      ElementSweep sweep = made();
      for (int change = 0; change < 60; ++change) {
        std::vector<Index> leaving, entering;
        const std::vector<Index> before = now.row;
        const Index x = static_cast<Index>(generator() % 23), y = static_cast<Index>(generator() % 9);
        const auto width = static_cast<Index>(1 + generator() % 6), height = static_cast<Index>(1 + generator() % 4);
        for (Index j = y; j < std::min(9, y + height); ++j) // a box changes hands
          for (Index i = x; i < std::min(23, x + width); ++i) {
            std::uint8_t& is = now.there[static_cast<std::size_t>(23 * j + i)];
            (is ? leaving : entering).push_back(23 * j + i);
            is = !is;
          }
        now.number();
        std::vector<Index> rows(before.size(), -1);
        for (std::size_t n = 0; n < before.size(); ++n)
          if (before[n] >= 0) rows[static_cast<std::size_t>(before[n])] = now.row[n];
        sweep.change({leaving, entering, rows, now.owned}, source);
        const ElementSweep anew = made();
        std::vector<double> r(2 * static_cast<std::size_t>(now.owned), 0.0), expected = r;
        sweep.add_force(now.values(), r);
        anew.add_force(now.values(), expected);
        ASSERT_EQ(r, expected) << "change " << change;
        ASSERT_EQ(sweep.energy(now.values()), anew.energy(now.values()));
        ASSERT_EQ(sweep.in_runs(), anew.in_runs());
      }
      EXPECT_GT(skew == 0.0 ? sweep.in_runs() : 1, 0);
    }
}
} // namespace element_sweeps
