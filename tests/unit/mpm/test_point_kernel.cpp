#include "pdx/mpm/point_kernel.hpp"

#include "pdx/base/symmetric.hpp"

#include <Eigen/LU>
#include <array>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

using namespace pdx;
using mpm::BodyMaterial;

namespace test_point_kernel {
/// A grid of cells of one body, all with the same points, corners displaced at random.
template <int Dim> struct Grid {
  BodyMaterial body;
  mpm::CellPoints<Dim> points;
  std::vector<mpm::CellRows<Dim>> cells;
  std::vector<mpm::CellRun<Dim>> runs;
  std::vector<double> u, v;

  /// @param length cells along a run
  Grid(const BodyMaterial& b, std::uint64_t mask, Index length) : body(b), points(b, mask)
  {
    const Index lines = 3, planes = Dim == 3 ? 2 : 1, per_line = length + 3; // rows of others in between
    for (Index z = 0; z < planes; ++z)
      for (Index y = 0; y < lines; ++y) {
        mpm::CellRun<Dim> run;
        run.cells = length;
        for (Index x = 0; x < length; ++x) {
          mpm::CellRows<Dim> rows;
          for (Index a = 0; a < mpm::kCorners<Dim>; ++a) { // a run goes along x, in space along z
            const Index along = Dim == 2 ? a & 1 : a >> 2, second = Dim == 2 ? a >> 1 : a & 1;
            const Index third = Dim == 2 ? 0 : a >> 1 & 1;
            rows[static_cast<std::size_t>(a)] = ((z + third) * (lines + 1) + y + second) * per_line + x + along;
          }
          for (std::size_t line = 0; x == 0 && line < run.first.size(); ++line)
            run.first[line] = rows[mpm::CellRun<Dim>::corner(line)];
          cells.push_back(rows);
        }
        runs.push_back(run);
      }
    std::mt19937 random(7);
    std::uniform_real_distribution<double> some(-0.1, 0.1);
    u.resize(static_cast<std::size_t>(per_line * (lines + 1) * (planes + 1) * Dim));
    for (double& x : u) x = some(random) * body.side();
    v = u;
    for (double& x : v) x = some(random);
  }
  mpm::NodeFields fields(std::vector<double>& r) const
  {
    r.assign(u.size(), 0.0);
    return {u.data(), v.data(), r.data(), static_cast<Index>(u.size()) / Dim};
  }

  /// Point by point, as the formulas say. @param stress first Piola, from H and dH/dt
  template <class Stress> std::vector<double> plainly(Stress&& stress) const
  {
    std::vector<double> r(u.size(), 0.0);
    for (const auto& rows : cells)
      for (std::size_t p = 0; p < points.sites.size(); ++p) {
        Tensor<Dim> h = Tensor<Dim>::Zero(), rate = h;
        for (int a = 0; a < mpm::kCorners<Dim>; ++a) {
          const auto at = static_cast<std::size_t>(rows[static_cast<std::size_t>(a)]) * Dim;
          h += Eigen::Map<const Vector<Dim>>(u.data() + at) * points.gradients[p].row(a);
          rate += Eigen::Map<const Vector<Dim>>(v.data() + at) * points.gradients[p].row(a);
        }
        const Tensor<Dim> force = points.volume * stress(h, rate);
        for (int a = 0; a < mpm::kCorners<Dim>; ++a)
          Eigen::Map<Vector<Dim>>(r.data() + static_cast<std::size_t>(rows[static_cast<std::size_t>(a)]) * Dim) +=
              force * points.gradients[p].row(a).transpose();
      }
    return r;
  }
};

std::vector<Processor> processors()
{
  std::vector<Processor> all;
  for (const Processor p : {Processor::any, Processor::avx2, Processor::avx512})
    if (p <= this_processor()) all.push_back(p);
  return all;
}

void expect_near(const std::vector<double>& found, const std::vector<double>& expected, double relative)
{
  double size = 0.0;
  for (const double x : expected) size = std::max(size, std::abs(x));
  EXPECT_GT(size, 0.0);
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_NEAR(found[i], expected[i], relative * size) << i;
}

BodyMaterial material(mpm::Law law, int ratio) { return {{10.0, 0.3, law::Plane::stress, 0.7, 4.0}, law, 0.05, ratio}; }

template <class D> struct PointKernel : ::testing::Test {
  static constexpr int kDim = D::value;
};
using Dimensions = ::testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(PointKernel, Dimensions);

TYPED_TEST(PointKernel, EveryVersionHasTheForcesOfPlainSums)
{
  constexpr int Dim = TestFixture::kDim;
  for (const mpm::Law law : {mpm::Law::corotational, mpm::Law::neo_hooke})
    for (const int ratio : {1, 2, 3})
      for (const Index length : {1, 2, 7, 8, 9, 17}) { // vectors full and not
        Grid<Dim> grid(material(law, ratio), mpm::full_mask<Dim>(ratio), length);
        grid.points.held = false;
        grid.points.hourglass.fill(0.0);
        const auto expected =
            grid.plainly([&](const Tensor<Dim>& h, const Tensor<Dim>&) { return mpm::law_stress<Dim>(grid.body, h); });
        std::vector<double> r;
        for (const Processor processor : processors()) {
          mpm::add_cell_forces<Dim>(processor, grid.body, grid.points, grid.cells, grid.fields(r));
          expect_near(r, expected, 1e-14);
          if (!mpm::runs_are_swept(ratio)) continue;
          mpm::add_run_forces<Dim>(processor, grid.body, grid.points, grid.runs, grid.fields(r));
          expect_near(r, expected, 1e-14);
        }
      }
}

TYPED_TEST(PointKernel, SomePointsOfACellActAsTheyWouldInAFullOne)
{
  constexpr int Dim = TestFixture::kDim;
  const std::uint64_t full = mpm::full_mask<Dim>(2), half = Dim == 2 ? 0b0110 : 0b10010110;
  const BodyMaterial body = material(mpm::Law::corotational, 2);
  std::vector<double> r, sum;
  Grid<Dim> whole(body, full, 5);
  mpm::add_run_forces<Dim>(this_processor(), body, whole.points, whole.runs, whole.fields(r));
  for (const std::uint64_t mask : {half, full & ~half}) {
    Grid<Dim> part(body, mask, 5);
    EXPECT_FALSE(part.points.held);
    std::vector<double> of_part;
    mpm::add_cell_forces<Dim>(this_processor(), body, part.points, part.cells, part.fields(of_part));
    sum.resize(of_part.size(), 0.0);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += of_part[i];
  }
  expect_near(sum, r, 1e-14);
}

TYPED_TEST(PointKernel, RowsOfOthersAreLeftAlone)
{
  constexpr int Dim = TestFixture::kDim;
  Grid<Dim> grid(material(mpm::Law::corotational, 2), mpm::full_mask<Dim>(2), 9);
  std::vector<double> r, all;
  mpm::add_cell_forces<Dim>(this_processor(), grid.body, grid.points, grid.cells, grid.fields(all));
  mpm::NodeFields fields = grid.fields(r);
  fields.owned = 15;
  mpm::add_cell_forces<Dim>(this_processor(), grid.body, grid.points, grid.cells, fields);
  for (std::size_t i = 0; i < r.size(); ++i) EXPECT_EQ(r[i], i < 15 * Dim ? all[i] : 0.0);
}

TYPED_TEST(PointKernel, CellsAtRestAreLeftOutWithoutChangingABit)
{
  constexpr int Dim = TestFixture::kDim;
  constexpr Index length = 41, per_line = length + 3;
  const auto bits = [](const std::vector<double>& r) {
    std::vector<std::uint64_t> all;
    for (const double x : r) all.push_back(std::bit_cast<std::uint64_t>(x));
    return all;
  };
  for (const mpm::Law law : {mpm::Law::corotational, mpm::Law::neo_hooke})
    for (const int ratio : {1, 2})
      for (const std::array<Index, 2> moving : {std::array<Index, 2>{0, 0}, {0, 1}, {7, 9}, {16, 25}, {40, 42}}) {
        Grid<Dim> grid(material(law, ratio), mpm::full_mask<Dim>(ratio), length);
        for (std::size_t i = 0; i < grid.u.size(); ++i) { // elsewhere 0, of either sign
          const Index x = static_cast<Index>(i / Dim) % per_line;
          if (x < moving[0] || x >= moving[1]) grid.u[i] = grid.v[i] = i % 3 ? 0.0 : -0.0;
        }
        const auto count = static_cast<std::int64_t>(grid.cells.size());
        const std::int64_t at_rest = count / length * (length - (moving[1] - moving[0]) - (moving[1] > moving[0]));
        for (const Processor processor : processors()) {
          std::vector<double> every, some;
          std::int64_t skipped = 0;
          const auto compare = [&](auto&& add, std::int64_t least) {
            add(grid.fields(every));
            mpm::NodeFields fields = grid.fields(some);
            fields.skipped = &skipped;
            skipped = 0;
            add(fields);
            EXPECT_EQ(bits(every), bits(some));
            EXPECT_LE(skipped, std::max<std::int64_t>(at_rest, 0) + count / length);
            EXPECT_GE(skipped, least);
          };
          const std::int64_t lanes = 8, least = at_rest - count / length * 2 * lanes; // a vector at each end moves
          const auto runs = [&](const auto& fields) {
            mpm::add_run_forces<Dim>(processor, grid.body, grid.points, grid.runs, fields);
          };
          const auto cells = [&](const auto& fields) {
            mpm::add_cell_forces<Dim>(processor, grid.body, grid.points, grid.cells, fields);
          };
          const auto viscous = [&](const auto& fields) {
            mpm::add_run_viscous<Dim>(processor, grid.body, grid.points, 0.1, grid.runs, fields);
          };
          compare(runs, least);
          compare(cells, least);
          compare(viscous, least);
        }
      }
}

TYPED_TEST(PointKernel, ViscosityIsThatOfTheRateOfVolume)
{
  constexpr int Dim = TestFixture::kDim;
  const double b = 0.06;
  for (const int ratio : {1, 2}) {
    Grid<Dim> grid(material(mpm::Law::corotational, ratio), mpm::full_mask<Dim>(ratio), 9);
    const double speed = law::Corotational<Dim>(grid.body.elastic).wave_speed(Tensor<Dim>::Zero());
    double power = 0.0;
    const auto expected = grid.plainly([&](const Tensor<Dim>& h, const Tensor<Dim>& rate) -> Tensor<Dim> {
      const Tensor<Dim> f = Tensor<Dim>::Identity() + h, inverse = f.inverse();
      const Tensor<Dim> p =
          b * 4.0 * speed * grid.body.side() * (inverse * rate).trace() * f.determinant() * inverse.transpose();
      power += grid.points.volume * p.cwiseProduct(rate).sum();
      return p;
    });
    EXPECT_GT(power, 0.0);
    std::vector<double> r;
    for (const Processor processor : processors()) {
      const double of_runs = mpm::add_run_viscous<Dim>(processor, grid.body, grid.points, b, grid.runs, grid.fields(r));
      expect_near(r, expected, 1e-13);
      EXPECT_NEAR(of_runs / power, 1.0, 1e-13);
      const double of_cells =
          mpm::add_cell_viscous<Dim>(processor, grid.body, grid.points, b, grid.cells, grid.fields(r));
      expect_near(r, expected, 1e-13);
      EXPECT_NEAR(of_cells / power, 1.0, 1e-13);
    }
  }
}

TYPED_TEST(PointKernel, HourglassControlHoldsWhatPointsDoNot)
{
  constexpr int Dim = TestFixture::kDim, rigid = Dim * (Dim + 1) / 2;
  for (const int ratio : {1, 2})
    for (std::uint64_t mask = 1; mask <= mpm::full_mask<Dim>(ratio); ++mask) {
      const BodyMaterial body = material(mpm::Law::corotational, ratio);
      const mpm::CellPoints<Dim> points(body, mask);
      const int many = std::popcount(mask);
      EXPECT_EQ(points.held, Dim == 2 ? many < 2 : many < 4 || points.held);
      if (Dim == 3 && many > 4) {
        EXPECT_FALSE(points.held) << mask;
      }
      const Eigen::VectorXd k =
          symmetric_eigenvalues(mpm::cell_tangent<Dim>(body, points, mpm::CellVector<Dim>::Zero()));
      EXPECT_NEAR(k[rigid - 1], 0.0, 1e-14 * k[k.size() - 1]) << mask;
      EXPECT_GT(k[rigid], 0.005 * k[k.size() - 1]) << mask;
    }
}

TEST(CellPoints, SquareOfOnePointBendsAsABeam)
{
  // u_x = a x y in a square of side h: strain energy E t a^2 h^4 / 24, that of u_xx = a y alone.
  const BodyMaterial body = material(mpm::Law::corotational, 1);
  const mpm::CellPoints<2> points(body, 1);
  const double a = 0.3, h = body.side();
  mpm::CellVector<2> u = mpm::CellVector<2>::Zero();
  for (int corner = 0; corner < 4; ++corner) u[2 * corner] = a * mpm::hourglass_sign(0, corner) * h * h / 4.0;
  const mpm::CellMatrix<2> k = mpm::cell_tangent<2>(body, points, mpm::CellVector<2>::Zero());
  EXPECT_NEAR(0.5 * u.dot(k * u) / (10.0 * 0.7 * a * a * std::pow(h, 4) / 24.0), 1.0, 1e-12);
}
} // namespace test_point_kernel
