#include "pdx/solve/dense_product.hpp"
#include "pdx/solve/inner_factor.hpp"

#include <gtest/gtest.h>
#include <numeric>

using namespace pdx;

namespace {
/// Springs between masses 0, 1, ... in a row; none where the stiffness is 0.
MatHandle chain(const std::vector<double>& springs)
{
  const auto size = static_cast<PetscInt>(springs.size()) + 1;
  MatHandle k;
  PDX_CALL(MatCreateSeqAIJ(PETSC_COMM_SELF, size, size, 3, nullptr, k.out()));
  for (PetscInt at = 0; at + 1 < size; ++at) {
    const PetscInt ends[] = {at, at + 1};
    const double s = springs[static_cast<std::size_t>(at)], block[] = {s, -s, -s, s};
    PDX_CALL(MatSetValues(k.get(), 2, ends, 2, ends, block, ADD_VALUES));
  }
  PDX_CALL(MatAssemblyBegin(k.get(), MAT_FINAL_ASSEMBLY));
  PDX_CALL(MatAssemblyEnd(k.get(), MAT_FINAL_ASSEMBLY));
  return k;
}
} // namespace

TEST(InnerFactor, SpringsInARowAreOneSpring)
{
  const MatHandle k = chain({1.0, 2.0, 4.0, 4.0}); // 1 + 1/2 + 1/4 + 1/4 = 2: as soft as one spring of 1/2
  const std::vector<PetscInt> inner{1, 2, 3}, outer{0, 4};
  std::vector<double> s;
  const solve::InnerFactor factor(k.get(), inner, outer, s);
  ASSERT_EQ(factor.fault(), "");
  ASSERT_EQ(s.size(), 4u);
  EXPECT_NEAR(s[0], 0.5, 1e-14);
  EXPECT_NEAR(s[1], -0.5, 1e-14);
  EXPECT_NEAR(s[2], -0.5, 1e-14);
  EXPECT_NEAR(s[3], 0.5, 1e-14);
  const std::vector<double> u = factor.answer(std::vector<double>{0.0, 2.0}); // the tension of 1 stretches each by 1/k
  ASSERT_EQ(u.size(), 3u);
  EXPECT_NEAR(u[0], 1.0, 1e-14);
  EXPECT_NEAR(u[1], 1.5, 1e-14);
  EXPECT_NEAR(u[2], 1.75, 1e-14);
  // A force of 1 at the first mass between resting ends: soft by 1 to the left, by 1 to the right.
  const std::vector<double> pushed = factor.solve({1.0, 0.0, 0.0});
  EXPECT_NEAR(pushed[0], 0.5, 1e-14);
  const std::vector<double> ends = factor.condensed({0.0, 0.0}, pushed);
  EXPECT_NEAR(ends[0], 0.5, 1e-14);
  EXPECT_NEAR(ends[1], 0.5, 1e-14);
}

TEST(InnerFactor, LeavesOutWhatIsNeitherInnerNorOuter)
{
  const MatHandle k = chain({1.0, 1.0, 3.0}); // the last mass is held: it is no unknown, but its spring stays
  std::vector<double> s;
  const solve::InnerFactor factor(k.get(), std::vector<PetscInt>{1, 2}, std::vector<PetscInt>{0}, s);
  ASSERT_EQ(factor.fault(), "");
  EXPECT_NEAR(s.at(0), 3.0 / 7.0, 1e-14); // 1 + 1 + 1/3
  std::vector<double> force(4, 0.0);
  solve::subtract_product(k.get(), std::vector<PetscInt>{3}, std::vector<double>{2.0}, force);
  EXPECT_EQ(force, (std::vector<double>{0.0, 0.0, 6.0, -6.0}));
}

TEST(InnerFactor, SaysWhereSomethingHangsOnNothing)
{
  const MatHandle k = chain({1.0, 0.0, 1.0, 0.0, 1.0});
  std::vector<double> s;
  const solve::InnerFactor factor(k.get(), std::vector<PetscInt>{1, 2, 3, 4}, std::vector<PetscInt>{0, 5}, s);
  EXPECT_NE(factor.fault(), "");
}

TEST(DenseProduct, AddsRowTimesVectorForAnySize)
{
  for (const std::size_t columns : {1u, 15u, 16u, 37u})
    for (const std::size_t rows : {1u, 3u, 4u, 9u}) {
      std::vector<double> a(rows * columns), x(columns), y(rows, 1.0), expected(rows, 1.0);
      for (std::size_t k = 0; k < a.size(); ++k) a[k] = static_cast<double>(k % 7) - 3.0;
      std::iota(x.begin(), x.end(), -4.0);
      for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < columns; ++c) expected[r] += a[r * columns + c] * x[c]; // whole numbers: exact
      solve::add_dense_product(a.data(), rows, columns, x.data(), y.data());
      EXPECT_EQ(y, expected) << rows << " x " << columns;
    }
}
