#pragma once
#include "pdx/base/petsc.hpp"

#include <petscdmplex.h>

/// Where PETSc's versions differ, nowhere else: 3.18 and 3.22 are tested. The form of a function is asked of
/// its type, not of a version number, so that what lies between needs no word.
namespace pdx {
namespace detail {
using BoxMesh318 = PetscErrorCode (*)(MPI_Comm, PetscInt, PetscBool, const PetscInt[], const PetscReal[],
                                      const PetscReal[], const DMBoundaryType[], PetscBool, DM*);
using BoxMesh322 = PetscErrorCode (*)(MPI_Comm, PetscInt, PetscBool, const PetscInt[], const PetscReal[],
                                      const PetscReal[], const DMBoundaryType[], PetscBool, PetscInt, PetscBool, DM*);

template <class Create>
PetscErrorCode create_quadrilaterals(Create create, MPI_Comm comm, const PetscInt cells[2], const PetscReal lower[2],
                                     const PetscReal upper[2], DM* plex)
{
  static_assert(std::is_same_v<Create, BoxMesh318> || std::is_same_v<Create, BoxMesh322>,
                "another PETSc: add its form");
  if constexpr (std::is_same_v<Create, BoxMesh318>)
    return create(comm, 2, PETSC_FALSE, cells, lower, upper, nullptr, PETSC_TRUE, plex);
  else // what is new matters in periodic boxes only
    return create(comm, 2, PETSC_FALSE, cells, lower, upper, nullptr, PETSC_TRUE, 0, PETSC_FALSE, plex);
}
} // namespace detail

/// `partition` as PetscPartitioner's operation of the form `Operation`: weights of edges, new in 3.22, are left aside.
template <class Operation, auto partition> struct PartitionOperation;
template <auto partition>
struct PartitionOperation<PetscErrorCode (*)(PetscPartitioner, PetscInt, PetscInt, PetscInt[], PetscInt[], PetscSection,
                                             PetscSection, PetscSection, IS*),
                          partition> {
  static constexpr auto value = partition;
};
template <auto partition>
struct PartitionOperation<PetscErrorCode (*)(PetscPartitioner, PetscInt, PetscInt, PetscInt[], PetscInt[], PetscSection,
                                             PetscSection, PetscSection, PetscSection, IS*),
                          partition> {
  static PetscErrorCode value(PetscPartitioner partitioner, PetscInt parts, PetscInt vertices, PetscInt start[],
                              PetscInt neighbours[], PetscSection vertex_weights, PetscSection, PetscSection targets,
                              PetscSection sizes, IS* order)
  {
    return partition(partitioner, parts, vertices, start, neighbours, vertex_weights, targets, sizes, order);
  }
};

/// MatRestrict tells a restriction from a prolongation by sizes: of a square matrix 3.18 asks for the product, 3.22 for
/// the transpose's. Tried once, on one number.
bool restricts_by_transpose();

/// A box of four-node cells, with edges and vertices.
inline PetscErrorCode create_quadrilaterals(MPI_Comm comm, const PetscInt cells[2], const PetscReal lower[2],
                                            const PetscReal upper[2], DM* plex)
{
  return detail::create_quadrilaterals(&DMPlexCreateBoxMesh, comm, cells, lower, upper, plex);
}
} // namespace pdx
