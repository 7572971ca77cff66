#include "pdx/io/natural_order.hpp"

#include "pdx/base/block_type.hpp"

namespace pdx::io {
namespace {
/// An even share for each rank.
class Shares {
public:
  Shares(MPI_Comm comm, PetscInt total) { PDX_CALL(PetscLayoutCreateFromSizes(comm, PETSC_DECIDE, total, 1, &raw_)); }
  ~Shares() { (void)PetscLayoutDestroy(&raw_); }
  Shares(const Shares&) = delete;
  Shares& operator=(const Shares&) = delete;
  PetscLayout get() const { return raw_; }
  Block mine() const
  {
    PetscInt first = 0, end = 0;
    PDX_CALL(PetscLayoutGetRange(raw_, &first, &end));
    return {first, end - first};
  }

private:
  PetscLayout raw_ = nullptr;
};
} // namespace

Block block_of(MPI_Comm comm, PetscInt total) { return Shares(comm, total).mine(); }

NaturalOrder::NaturalOrder(MPI_Comm comm, PetscInt total, std::span<const PetscInt> held)
{
  const Shares shares(comm, total);
  block_ = shares.mine();
  PDX_CALL(PetscSFCreate(comm, sf_.out()));
  PDX_CALL(PetscSFSetGraphLayout(sf_.get(), shares.get(), static_cast<PetscInt>(held.size()), nullptr,
                                 PETSC_COPY_VALUES, held.data()));
  PDX_CALL(PetscSFSetUp(sf_.get()));
}

template <class T> std::vector<T> NaturalOrder::gather(std::span<const T> values, int components) const
{
  static_assert(sizeof(T) == sizeof(double));
  const MPI_Datatype type = block_type(components); // eight bytes each, copied and never looked at
  std::vector<T> block(static_cast<std::size_t>(block_.rows) * static_cast<std::size_t>(components), T{});
  PDX_CALL(PetscSFReduceBegin(sf_.get(), type, values.data(), block.data(), MPI_REPLACE));
  PDX_CALL(PetscSFReduceEnd(sf_.get(), type, values.data(), block.data(), MPI_REPLACE));
  return block;
}

std::vector<double> NaturalOrder::to_table(std::span<const double> values, int components) const
{
  return gather<double>(values, components);
}

std::vector<std::uint64_t> NaturalOrder::to_table(std::span<const std::uint64_t> values, int components) const
{
  return gather<std::uint64_t>(values, components);
}
} // namespace pdx::io
