#include "pdx/io/natural_order.hpp"

#include "pdx/base/block_type.hpp"

namespace pdx::io {
NaturalOrder::NaturalOrder(MPI_Comm comm, PetscInt total, std::span<const PetscInt> held) : held_(held.size())
{
  PetscLayout layout = nullptr;
  PDX_CALL(PetscLayoutCreateFromSizes(comm, PETSC_DECIDE, total, 1, &layout));
  PetscInt end = 0;
  PDX_CALL(PetscLayoutGetRange(layout, &first_, &end));
  rows_ = end - first_;
  PDX_CALL(PetscSFCreate(comm, sf_.out()));
  PDX_CALL(PetscSFSetGraphLayout(sf_.get(), layout, static_cast<PetscInt>(held.size()), nullptr, PETSC_COPY_VALUES,
                                 held.data()));
  PDX_CALL(PetscSFSetUp(sf_.get()));
  PDX_CALL(PetscLayoutDestroy(&layout));
}

template <class T> std::vector<T> NaturalOrder::gather(std::span<const T> values, int components) const
{
  static_assert(sizeof(T) == sizeof(double));
  const MPI_Datatype type = block_type(components); // eight bytes each, copied and never looked at
  std::vector<T> block(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(components), T{});
  PDX_CALL(PetscSFReduceBegin(sf_.get(), type, values.data(), block.data(), MPI_REPLACE));
  PDX_CALL(PetscSFReduceEnd(sf_.get(), type, values.data(), block.data(), MPI_REPLACE));
  return block;
}

template <class T> std::vector<T> NaturalOrder::spread(std::span<const T> block, int components) const
{
  static_assert(sizeof(T) == sizeof(double));
  const MPI_Datatype type = block_type(components); // eight bytes each, copied and never looked at
  std::vector<T> values(held_ * static_cast<std::size_t>(components), T{});
  PDX_CALL(PetscSFBcastBegin(sf_.get(), type, block.data(), values.data(), MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(sf_.get(), type, block.data(), values.data(), MPI_REPLACE));
  return values;
}

std::vector<double> NaturalOrder::to_table(std::span<const double> values, int components) const
{
  return gather<double>(values, components);
}

std::vector<std::uint64_t> NaturalOrder::to_table(std::span<const std::uint64_t> values, int components) const
{
  return gather<std::uint64_t>(values, components);
}

std::vector<double> NaturalOrder::from_table(std::span<const double> block, int components) const
{
  return spread<double>(block, components);
}

std::vector<std::uint64_t> NaturalOrder::from_table(std::span<const std::uint64_t> block, int components) const
{
  return spread<std::uint64_t>(block, components);
}
} // namespace pdx::io
