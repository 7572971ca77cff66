#include "pdx/field/rows.hpp"

#include "pdx/base/block_type.hpp"

#include <algorithm>

namespace pdx::field {
Rows Rows::number(MPI_Comm comm, int dim, Index nodes, Index enriched, Index particles)
{
  Rows rows{comm, dim, nodes, enriched, particles, 0, 0};
  const PetscInt owned = rows.owned();
  PetscInt end = 0;
  MPI_Scan(&owned, &end, 1, MPIU_INT, MPI_SUM, comm);
  rows.first = end - owned;
  MPI_Allreduce(&owned, &rows.total, 1, MPIU_INT, MPI_SUM, comm);
  return rows;
}

std::vector<double> owned_values(Vec u)
{
  PetscInt size = 0;
  const double* values = nullptr;
  PDX_CALL(VecGetLocalSize(u, &size));
  PDX_CALL(VecGetArrayRead(u, &values));
  std::vector<double> copy(values, values + size);
  PDX_CALL(VecRestoreArrayRead(u, &values));
  return copy;
}

void set_owned_values(Vec u, std::span<const double> values)
{
  double* to = nullptr;
  PDX_CALL(VecGetArrayWrite(u, &to));
  std::ranges::copy(values, to);
  PDX_CALL(VecRestoreArrayWrite(u, &to));
}

VecHandle Rows::vector() const
{
  VecHandle v;
  PDX_CALL(VecCreate(comm, v.out()));
  PDX_CALL(VecSetSizes(v.get(), dim * owned(), PETSC_DETERMINE));
  PDX_CALL(VecSetBlockSize(v.get(), dim));
  PDX_CALL(VecSetType(v.get(), VECSTANDARD));
  PDX_CALL(VecSet(v.get(), 0.0));
  return v;
}

RowHalo::RowHalo(const Rows& rows, std::vector<PetscInt> needed) : rows_(rows)
{
  std::erase_if(needed, [&](PetscInt row) { return row < 0 || rows.owns(row); });
  std::sort(needed.begin(), needed.end());
  needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
  halo_ = std::move(needed);
  PetscLayout layout = nullptr;
  PDX_CALL(PetscLayoutCreateFromSizes(rows.comm, rows.owned(), rows.total, 1, &layout));
  PDX_CALL(PetscSFCreate(rows.comm, sf_.out()));
  PDX_CALL(PetscSFSetGraphLayout(sf_.get(), layout, static_cast<PetscInt>(halo_.size()), nullptr, PETSC_COPY_VALUES,
                                 halo_.data()));
  PDX_CALL(PetscSFSetUp(sf_.get()));
  PDX_CALL(PetscLayoutDestroy(&layout));
}

Index RowHalo::local(PetscInt row) const
{
  if (rows_.owns(row)) return row - rows_.first;
  const auto at = std::lower_bound(halo_.begin(), halo_.end(), row);
  if (at == halo_.end() || *at != row)
    throw std::logic_error("row " + std::to_string(row) + " was not announced as needed");
  return rows_.owned() + static_cast<Index>(at - halo_.begin());
}

PetscInt RowHalo::global(Index local) const
{
  return local < rows_.owned() ? rows_.first + local : halo_[static_cast<std::size_t>(local - rows_.owned())];
}

void RowHalo::fetch(std::span<const double> owned, int components, std::vector<double>& all) const
{
  const std::size_t own = static_cast<std::size_t>(rows_.owned()) * static_cast<std::size_t>(components);
  all.resize(static_cast<std::size_t>(size()) * static_cast<std::size_t>(components));
  std::copy_n(owned.begin(), own, all.begin());
  broadcast(all.data(), components);
}

void RowHalo::refresh(std::span<double> blocks) const { broadcast(blocks.data(), rows_.dim); }

void RowHalo::broadcast(double* all, int components) const
{
  double* halo = all + static_cast<std::ptrdiff_t>(rows_.owned()) * components;
  PDX_CALL(PetscSFBcastBegin(sf_.get(), block_type(components), all, halo, MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(sf_.get(), block_type(components), all, halo, MPI_REPLACE));
}

void RowHalo::reduce(std::vector<double>& all, int components) const
{
  const std::size_t own = static_cast<std::size_t>(rows_.owned()) * static_cast<std::size_t>(components);
  PDX_CALL(PetscSFReduceBegin(sf_.get(), block_type(components), all.data() + own, all.data(), MPI_SUM));
  PDX_CALL(PetscSFReduceEnd(sf_.get(), block_type(components), all.data() + own, all.data(), MPI_SUM));
}

void RowHalo::gather(Vec u, std::vector<double>& blocks) const
{
  const double* values = nullptr;
  PDX_CALL(VecGetArrayRead(u, &values));
  fetch({values, static_cast<std::size_t>(rows_.owned()) * static_cast<std::size_t>(rows_.dim)}, rows_.dim, blocks);
  PDX_CALL(VecRestoreArrayRead(u, &values));
}
} // namespace pdx::field
