#include "pdx/field/row_move.hpp"

#include "pdx/base/block_type.hpp"
#include "pdx/base/directory.hpp"

#include <algorithm>

namespace pdx::field {
namespace {
std::vector<std::uint64_t> values_of(std::span<const RowName> names)
{
  std::vector<std::uint64_t> values(names.size());
  std::ranges::transform(names, values.begin(), &RowName::value);
  return values;
}
} // namespace

RowMove::RowMove(MPI_Comm comm, std::span<const RowName> from, std::span<const RowName> to) : wanted_(to.size())
{
  const Directory directory(comm, values_of(from));
  unique_ = directory.unique();
  const std::vector<Whereabouts> found = directory.find(values_of(to));
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k].found()) {
      fresh_.push_back(static_cast<Index>(k));
      continue;
    }
    leaves.push_back(static_cast<PetscInt>(k));
    roots.push_back({found[k].rank, found[k].place});
  }
  PDX_CALL(PetscSFCreate(comm, sf_.out()));
  PDX_CALL(PetscSFSetGraph(sf_.get(), static_cast<PetscInt>(from.size()), static_cast<PetscInt>(leaves.size()),
                           leaves.data(), PETSC_COPY_VALUES, roots.data(), PETSC_COPY_VALUES));
  PDX_CALL(PetscSFSetUp(sf_.get()));
}

std::vector<Index> RowMove::left_behind() const
{
  const PetscInt* degrees = nullptr;
  PetscInt roots = 0;
  PDX_CALL(PetscSFGetGraph(sf_.get(), &roots, nullptr, nullptr, nullptr));
  PDX_CALL(PetscSFComputeDegreeBegin(sf_.get(), &degrees));
  PDX_CALL(PetscSFComputeDegreeEnd(sf_.get(), &degrees));
  std::vector<Index> places;
  for (PetscInt k = 0; k < roots; ++k)
    if (degrees[k] == 0) places.push_back(k);
  return places;
}

template <class T> std::vector<T> RowMove::spread(std::span<const T> values, int components) const
{
  static_assert(sizeof(T) == sizeof(double));
  const MPI_Datatype type = block_type(components); // eight bytes each, copied and never looked at
  std::vector<T> carried(wanted_ * static_cast<std::size_t>(components), T{});
  PDX_CALL(PetscSFBcastBegin(sf_.get(), type, values.data(), carried.data(), MPI_REPLACE));
  PDX_CALL(PetscSFBcastEnd(sf_.get(), type, values.data(), carried.data(), MPI_REPLACE));
  return carried;
}

std::vector<double> RowMove::carry(std::span<const double> values, int components) const
{
  return spread<double>(values, components);
}

std::vector<std::uint64_t> RowMove::carry(std::span<const std::uint64_t> values, int components) const
{
  return spread<std::uint64_t>(values, components);
}
} // namespace pdx::field
