#include "pdx/pd/site_directory.hpp"

#include <numeric>

namespace pdx::pd {
namespace {
/// Star forest from the evenly spread table to the given sites.
SfHandle spread(MPI_Comm comm, Index total, std::span<const Index> sites, Index& local)
{
  PetscLayout layout = nullptr;
  SfHandle sf;
  PDX_CALL(PetscLayoutCreateFromSizes(comm, PETSC_DECIDE, total, 1, &layout));
  PDX_CALL(PetscLayoutGetLocalSize(layout, &local));
  PDX_CALL(PetscSFCreate(comm, sf.out()));
  PDX_CALL(PetscSFSetGraphLayout(sf.get(), layout, static_cast<PetscInt>(sites.size()), nullptr, PETSC_COPY_VALUES,
                                 sites.data()));
  PDX_CALL(PetscSFSetUp(sf.get()));
  PDX_CALL(PetscLayoutDestroy(&layout));
  return sf;
}
} // namespace

SiteDirectory::SiteDirectory(MPI_Comm comm, Index total_sites, std::span<const Index> sites, PetscInt first_row)
    : comm_(comm), total_(total_sites)
{
  Index local = 0;
  const SfHandle sf = spread(comm, total_, sites, local);
  table_.assign(static_cast<std::size_t>(local), -1);
  std::vector<PetscInt> rows(sites.size());
  std::iota(rows.begin(), rows.end(), first_row);
  PDX_CALL(PetscSFReduceBegin(sf.get(), MPIU_INT, rows.data(), table_.data(), MPI_REPLACE));
  PDX_CALL(PetscSFReduceEnd(sf.get(), MPIU_INT, rows.data(), table_.data(), MPI_REPLACE));
}

std::vector<PetscInt> SiteDirectory::rows(std::span<const Index> sites) const
{
  Index local = 0;
  const SfHandle sf = spread(comm_, total_, sites, local);
  std::vector<PetscInt> rows(sites.size(), -1);
  PDX_CALL(PetscSFBcastBegin(sf.get(), MPIU_INT, table_.data(), rows.data(), MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(sf.get(), MPIU_INT, table_.data(), rows.data(), MPI_REPLACE));
  return rows;
}
} // namespace pdx::pd
