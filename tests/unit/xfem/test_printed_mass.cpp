#include "cut_plate.hpp"
#include "pdx/base/symmetric.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
/// Diagonal masses of (u, a) as printed [XPD2 Eqs. 4-7], for density and thickness 1: row sums for u, and for the sets
/// the integral of psi^2 over the cell, shared by the area of the part that holds the node and the nodes in it.
Eigen::VectorXd printed_masses(const CutPlate& plate)
{
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(plate.unknowns());
  plate.for_each_cell([&](const xfem::EnrichedElement& element, const std::vector<int>& at) {
    double psi_squared = 0.0, whole = 0.0;
    std::array<double, 2> area{};
    for (const xfem::Side side : xfem::kSides)
      for (const xfem::PartPoint& point : element.cell.points(side)) {
        double psi = 0.0;
        for (std::size_t a = 0; a < 4; ++a)
          if (element.enriched[a])
            psi += point.shape[static_cast<Eigen::Index>(a)] * xfem::shifted_step(side, element.side[a]);
        psi_squared += point.area * psi * psi;
        area[static_cast<std::size_t>(side)] += point.area;
        whole += point.area;
      }
    std::size_t set = 4;
    for (std::size_t a = 0; a < 4; ++a) {
      const auto nodes_beside = std::ranges::count(element.side, element.side[a]);
      const double part = area[static_cast<std::size_t>(element.side[a])];
      for (std::size_t d = 0; d < 2; ++d) {
        mass[at[2 * a + d]] += 0.25 * whole;
        if (element.enriched[a])
          mass[at[2 * set + d]] += part / whole / static_cast<double>(nodes_beside) * psi_squared;
      }
      set += element.enriched[a];
    }
  });
  return mass;
}

CutPlate plate_cut_above_nodes_by(double gap)
{
  CutPlate plate(3, 1.0);
  plate.rule.least_share = 0.0;
  plate.cut({{0.0, 1.0 + gap}, 0.0});
  return plate;
}

double largest_frequency_squared(const CutPlate& plate, const Eigen::VectorXd& mass)
{
  const Eigen::VectorXd scale = mass.cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd k = scale.asDiagonal() * plate.rest_tangent() * scale.asDiagonal();
  return symmetric_eigenvalues(k).maxCoeff();
}

TEST(PrintedMass, GrowsStiffWithoutBoundAsTheCrackNearsNodes)
{
  const CutPlate middle = plate_cut_above_nodes_by(0.5);
  const double whole = largest_frequency_squared(middle, printed_masses(middle));
  double before = 0.0;
  for (const double gap : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const CutPlate plate = plate_cut_above_nodes_by(gap);
    const double ratio = largest_frequency_squared(plate, printed_masses(plate)) / whole;
    if (std::getenv("PDX_SHOW")) std::printf("gap %g: omega^2 / omega^2(1/2) = %g\n", gap, ratio);
    EXPECT_GT(ratio * gap, 0.1); // the sets of the near nodes weigh gap, and are as stiff as ever
    if (before > 0.0) {
      EXPECT_NEAR(ratio / before, 10.0, 1.0);
    }
    before = ratio;
  }
}

/// Half a body in motion: u = v on its nodes, a = v / 2 on those below the crack; the set's energy is 1/4 of what its
/// mass has at v.
TEST(PrintedMass, MissesTheKineticEnergyOfEitherHalf)
{
  for (const double gap : {0.5, 0.1, 1e-3}) {
    const CutPlate plate = plate_cut_above_nodes_by(gap);
    const Line line{{0.0, 1.0 + gap}, 0.0};
    const Eigen::VectorXd d = plate.unknowns_of(
        line, [](const Vector<2>&, xfem::Side side) { return Vector<2>(side == xfem::Side::plus ? 1.0 : 0.0, 0.0); });
    const double found = 0.5 * d.cwiseAbs2().dot(printed_masses(plate)), exact = 0.5 * 3.0 * (2.0 - gap);
    if (std::getenv("PDX_SHOW")) std::printf("gap %g: kinetic energy %g of %g\n", gap, found, exact);
    EXPECT_GT(std::abs(found - exact), 0.01 * exact) << gap;
  }
}
} // namespace
