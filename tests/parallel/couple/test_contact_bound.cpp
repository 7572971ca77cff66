#include "support/touching.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

using namespace pdx;
using test::Touching;

namespace test_contact_bound {
/// Least eigenvalue of bound - tangent, over the largest of the bound; the tangent is the difference of forces at a
/// scene that just touches.
template <int Dim>
double slack_of_bound(Touching<Dim>& scene, const std::function<Vector<Dim>(const typename Touching<Dim>::Row&)>& u)
{
  const auto size = static_cast<Eigen::Index>(scene.rows.size() * Dim);
  Eigen::MatrixXd difference(size, size);
  (void)scene.contact_force(scene.blocks(u));
  (void)scene.contact->slip(); // grips, if there is friction
  constexpr double kStep = 1e-7;
  for (Eigen::Index k = 0; k < size; ++k) {
    const auto at = [&](double step) {
      return scene.contact_force(scene.blocks([&](const auto& row) {
        Vector<Dim> moved = u(row);
        if (&row == &scene.rows[static_cast<std::size_t>(k / Dim)]) moved[k % Dim] += step;
        return moved;
      }));
    };
    const std::vector<double> more = at(kStep), less = at(-kStep);
    for (Eigen::Index i = 0; i < size; ++i)
      difference(i, k) = -(more[static_cast<std::size_t>(i)] - less[static_cast<std::size_t>(i)]) / (2.0 * kStep);
  }
  const double largest = -difference.minCoeff();
  EXPECT_GT(largest, 0.1);
  std::vector<double> blocks(scene.mine.size() * Dim * Dim, 0.0);
  scene.contact->add_stiffness_bound(blocks);
  std::vector<double> diagonal(scene.mine.size() * Dim);
  for (std::size_t i = 0; i < diagonal.size(); ++i) diagonal[i] = blocks[i / Dim * Dim * Dim + i % Dim * (Dim + 1)];
  const std::vector<double> bound = scene.of_all(diagonal);
  for (Eigen::Index k = 0; k < size; ++k) difference(k, k) += bound[static_cast<std::size_t>(k)];
  const Eigen::MatrixXd symmetric = 0.5 * (difference + difference.transpose());
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric, Eigen::EigenvaluesOnly).eigenvalues().minCoeff() /
         *std::ranges::max_element(bound);
}

template <class T> class ContactBound : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(ContactBound, Dimensions);

TYPED_TEST(ContactBound, IsNeverExceeded)
{
  constexpr int kDim = TypeParam::value;
  Site<kDim> wide, narrow;
  wide.fill(2), narrow.fill(2);
  wide[0] = 6, narrow[0] = 4;
  for (const double friction : {0.0, 0.5})
    for (const double size : {1.0, 2.0})
      for (const double along : {0.0, 0.2, 0.5})
        for (const double turn : {0.0, 0.7854}) { // a face, a corner
          couple::ContactOptions options;
          options.friction = friction;
          Vector<kDim> corner = Vector<kDim>::Constant(0.1 + along);
          corner[0] += turn > 0.0 ? 2.0 : 0.5;
          corner[1] = 4.0;
          if (kDim == 3) corner[2] = 0.8 * along;
          Touching<kDim> scene(PETSC_COMM_WORLD,
                               {{"below", Vector<kDim>::Zero(), wide, 1.0, 1.0, 1.0, kDim == 2},
                                {"above", corner, narrow, size, 2.0, 1.0, false, false, Vector<kDim>::Zero(), turn}},
                               options);
          double lowest = 1e300;
          for (const auto& row : scene.rows) lowest = std::min(lowest, row.body == 1 ? row.x[1] : 1e300);
          const double gap = turn > 0.0 && along > 0.1 ? std::sqrt(0.25 * (1.0 + size) * (1.0 + size) - 0.2 * 0.2)
                                                       : 0.5 * (1.0 + size);
          const double slack = slack_of_bound<kDim>(scene, [&](const auto& row) -> Vector<kDim> {
            return (row.body == 1 ? 1.5 + gap - 1e-4 - lowest : 0.0) * Vector<kDim>::Unit(1);
          });
          EXPECT_GT(slack, -1e-6) << friction << ' ' << size << ' ' << along << ' ' << turn;
        }
}
} // namespace test_contact_bound
