#include "pdx/base/petsc.hpp"

#include <gtest/gtest.h>

/// All ranks run all tests; rank 0 reports; a failure on any rank fails the program.
int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  if (PetscInitialize(&argc, &argv, nullptr, nullptr)) return 2;
  pdx::install_quiet_error_handler();
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) {
    auto& listeners = testing::UnitTest::GetInstance()->listeners();
    delete listeners.Release(listeners.default_result_printer());
  }
  int failed = RUN_ALL_TESTS();
  if (failed && rank) fprintf(stderr, "rank %d failed too; run with --gtest_filter to see what\n", rank);
  MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
  PetscFinalize();
  return failed;
}
