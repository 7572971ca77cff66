#include "pdx/field/row_shift.hpp"

#include <gtest/gtest.h>

using namespace pdx;

// Ten rows: 0 to 3 stay, 4 and 5 go, 6 to 8 move up by two, 9 goes; 2 new ones come at the end.
TEST(RowShift, FollowsRunsOfRows)
{
  const field::Rows before = field::Rows::number(PETSC_COMM_SELF, 2, 10, 0, 0);
  const field::Rows after = field::Rows::number(PETSC_COMM_SELF, 2, 9, 0, 0);
  const field::RowShift::Run runs[] = {{0, 0, 4}, {6, 4, 3}};
  const field::RowShift shift(std::make_unique<field::RowHalo>(before, std::vector<PetscInt>()), runs);
  const PetscInt expected[] = {0, 1, 2, 3, -1, -1, 4, 5, 6, -1};
  for (PetscInt row = 0; row < 10; ++row) EXPECT_EQ(shift(row), expected[row]) << row;
  const field::RowHalo now(after, {});
  const std::vector<Index> local = shift.local_rows(now, {});
  ASSERT_EQ(local.size(), 10u);
  for (std::size_t row = 0; row < local.size(); ++row) EXPECT_EQ(local[row], expected[row]) << row;
}

TEST(RowShift, OfNoRunsLetsAllGo)
{
  const field::Rows before = field::Rows::number(PETSC_COMM_SELF, 2, 3, 0, 0);
  const field::RowShift shift(std::make_unique<field::RowHalo>(before, std::vector<PetscInt>()), {});
  for (PetscInt row = 0; row < 3; ++row) EXPECT_EQ(shift(row), -1);
}
