#include "pdx/post/nonlocal_j.hpp"
#include "support/bare_patch.hpp"

#include <Eigen/SparseCholesky>
#include <gtest/gtest.h>

using namespace pdx;

namespace {
constexpr Index kSide = 64; // particles; unit square, every rank for itself
const geom::Lattice<2> kLattice{{0.0, 0.0}, 1.0 / kSide, {kSide, kSide}};
const Vector<2> kTip(0.5, 0.5);

/// A square plate of particles, cracked from the left to `tip`, its top and bottom rows pulled apart.
class CrackedPlate {
public:
  explicit CrackedPlate(const Vector<2>& tip) : patch(PETSC_COMM_SELF, kLattice, 4.0)
  {
    patch.cut(crack::CrackSet({{{0.0, tip.y()}, tip}}, {{0.0, 0.0}, {1.0, 1.0}}));
    u = patch.displacement([](const Vector<2>& x) {
      const double pull = x.y() > 0.5 ? 1e-3 : -1e-3;
      return Vector<2>(0.0, held(x) ? pull : 0.0);
    });
    solve();
    w = patch.density(u);
  }

  /// Strain energy per thickness [J/m].
  double energy() const
  {
    double sum = 0.0;
    for (const double density : w) sum += density * kLattice.dx * kLattice.dx;
    return sum;
  }

  test::BarePatch patch;
  std::vector<double> u, w;

private:
  static bool held(const Vector<2>& x) { return std::abs(x.y() - 0.5) > 0.5 - 4.0 * kLattice.dx; }

  void solve()
  {
    const auto& part = patch.part();
    const auto size = static_cast<Eigen::Index>(u.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size);
    for (std::size_t k = 0; k < part.sites().size(); ++k) {
      const auto i = static_cast<int>(2 * k);
      if (held(patch.point(k))) {
        for (const int a : {0, 1}) {
          entries.emplace_back(i + a, i + a, 1.0);
          right[i + a] = u[2 * k + static_cast<std::size_t>(a)];
        }
        continue;
      }
      part.for_each_bond(static_cast<Index>(k), [&](std::size_t h, int, const Site<2>& other, double weight) {
        const pd::Arm<2>& arm = part.stencil().half[h];
        const auto rest = law::linear_state<2>(arm.xi, arm.length, Vector<2>::Zero());
        const Tensor<2> stiffness = law::bond_stiffness<2>(weight * arm.kappa, arm.length, rest);
        const auto j = 2 * static_cast<int>(part.row(other));
        const bool fixed = held(kLattice.point(other));
        for (const int a : {0, 1})
          for (const int b : {0, 1}) {
            entries.emplace_back(i + a, i + b, stiffness(a, b));
            if (fixed)
              right[i + a] += stiffness(a, b) * u[static_cast<std::size_t>(j + b)];
            else
              entries.emplace_back(i + a, j + b, -stiffness(a, b));
          }
      });
    }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd solution = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(right);
    u.assign(solution.data(), solution.data() + size);
  }
};

const std::vector<post::SquareContour> kContours{{kTip, 0.25}, {kTip, 0.4}, {kTip, 0.55}, {kTip, 0.7}, {kTip, 0.85}};

std::vector<post::ContourJ> contour_j(const CrackedPlate& plate, std::span<const post::SquareContour> contours)
{
  return post::nonlocal_j({PETSC_COMM_SELF, plate.patch.part(), law::Kinematics::small, plate.u, plate.w},
                          Vector<2>::UnitX(), contours);
}
} // namespace

TEST(ContourJ, IsTheEnergyReleasedPerCrackLengthOnAnyContour)
{
  const double dx = kLattice.dx;
  const double released =
      (CrackedPlate({0.5 - dx, 0.5}).energy() - CrackedPlate({0.5 + dx, 0.5}).energy()) / (2.0 * dx);
  ASSERT_GT(released, 0.0);
  const CrackedPlate plate(kTip);
  for (const auto& [j, side] : contour_j(plate, kContours)) EXPECT_NEAR(j, released, 2e-4 * released) << side;
}

// The sum is a conservation law of the lattice itself, so the path does not matter beyond the solver's rounding.
TEST(ContourJ, DoesNotDependOnThePath)
{
  const CrackedPlate plate({0.5, 0.5});
  std::vector<post::SquareContour> contours = kContours;
  contours.push_back({{0.55, 0.47}, 0.3});
  const auto found = contour_j(plate, contours);
  for (const auto& [j, side] : found) EXPECT_NEAR(j, found[0].j, 1e-9 * found[0].j) << side;
}

// Around the crack's middle, beside it or before it there is no tip.
TEST(ContourJ, VanishesWithoutATipInside)
{
  const CrackedPlate plate(kTip);
  const double at_tip = contour_j(plate, kContours)[1].j;
  const std::vector<post::SquareContour> away{{{0.25, 0.5}, 0.25}, {{0.5, 0.75}, 0.25}, {{0.75, 0.5}, 0.25}};
  for (const auto& [j, side] : contour_j(plate, away)) EXPECT_NEAR(j, 0.0, 1e-9 * at_tip);
}
