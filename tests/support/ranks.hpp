#pragma once
#include "pdx/base/petsc.hpp"

namespace pdx::test {
inline int rank()
{
  int number = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &number);
  return number;
}
inline int ranks()
{
  int number = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &number);
  return number;
}
/// Over all ranks. Collective.
inline double sum(double mine)
{
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, PETSC_COMM_WORLD);
  return mine;
}
inline double largest(double mine)
{
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_MAX, PETSC_COMM_WORLD);
  return mine;
}
} // namespace pdx::test
