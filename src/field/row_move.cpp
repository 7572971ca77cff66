#include "pdx/field/row_move.hpp"

#include "pdx/base/block_type.hpp"
#include "pdx/base/directory.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <bit>
#include <numeric>

namespace pdx::field {
namespace {
std::vector<std::uint64_t> values_of(std::span<const RowName> names)
{
  std::vector<std::uint64_t> values(names.size());
  std::ranges::transform(names, values.begin(), &RowName::value);
  return values;
}

/// Finds names among those given.
class PlaceFinder {
public:
  explicit PlaceFinder(std::span<const RowName> names) : names_(names) {}
  /// The place of a name, -1 if it is not there.
  Index find(RowName name, std::size_t likely)
  {
    if (likely < names_.size() && names_[likely] == name) return static_cast<Index>(likely);
    if (slots_.empty()) fill();
    return slots_[slot(name)];
  }

private:
  /// A table of places by a hash of names, at most half full.
  void fill()
  {
    slots_.assign(std::bit_ceil(2 * names_.size() + 2), -1);
    for (std::size_t k = 0; k < names_.size(); ++k)
      if (!(names_[k] == RowName())) slots_[slot(names_[k])] = static_cast<Index>(k);
  }
  /// Where a name is, or would be.
  std::size_t slot(RowName name) const
  {
    constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15; // 2^64 over the golden ratio
    std::size_t at = (name.value() * kGolden >> 32) % slots_.size();
    while (slots_[at] >= 0 && !(names_[static_cast<std::size_t>(slots_[at])] == name)) at = (at + 1) % slots_.size();
    return at;
  }

  std::span<const RowName> names_;
  std::vector<Index> slots_;
};
} // namespace

RowMove::RowMove(MPI_Comm comm, std::span<const RowName> from, std::span<const RowName> to, Wanted wanted)
    : wanted_(to.size()), stays_(from.size(), 0)
{
  std::vector<Index> places;
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  if (ranks == 1 && wanted != Wanted::often) {
    fresh_ = find_here(from, to);
    return;
  }
  if (wanted == Wanted::once) {
    places = find_here(from, to);
    if (!any_rank(comm, !places.empty())) return;
  } else {
    places.resize(to.size());
    std::iota(places.begin(), places.end(), Index{0});
  }
  std::vector<std::uint64_t> others = values_of(from);
  for (std::size_t k = 0; k < others.size(); ++k)
    if (stays_[k]) others[k] = 0;
  find_anywhere(comm, std::move(others), to, places);
}

/// @return places in `to` of what is not on this rank; most names follow the one before on either side
std::vector<Index> RowMove::find_here(std::span<const RowName> from, std::span<const RowName> to)
{
  PlaceFinder finder(from);
  std::vector<Index> missing;
  std::size_t next = 0; // place in `from` that is likely
  for (std::size_t k = 0; k < to.size();) {
    const Index place = finder.find(to[k], next);
    if (place < 0) {
      missing.push_back(static_cast<Index>(k++));
      continue;
    }
    const auto begin = static_cast<std::size_t>(place);
    const std::size_t most = std::min(from.size() - begin, to.size() - k);
    std::size_t length = 1;
    while (length < most && from[begin + length] == to[k + length]) ++length;
    std::fill_n(stays_.begin() + place, length, std::uint8_t{1});
    runs_.push_back({place, static_cast<Index>(k), static_cast<Index>(length)});
    k += length;
    next = begin + length;
  }
  return missing;
}

/// @param from names by place, 0 for none   @param places in `to` that are looked for
void RowMove::find_anywhere(MPI_Comm comm, std::vector<std::uint64_t> from, std::span<const RowName> to,
                            std::span<const Index> places)
{
  const Directory directory(comm, from);
  unique_ = directory.unique();
  std::vector<std::uint64_t> names(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) names[k] = to[static_cast<std::size_t>(places[k])].value();
  const std::vector<Whereabouts> found = directory.find(names);
  std::vector<PetscInt> leaves;
  std::vector<PetscSFNode> roots;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!found[k].found()) {
      fresh_.push_back(places[k]);
      continue;
    }
    leaves.push_back(places[k]);
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
  if (sf_.get()) {
    PDX_CALL(PetscSFComputeDegreeBegin(sf_.get(), &degrees));
    PDX_CALL(PetscSFComputeDegreeEnd(sf_.get(), &degrees));
  }
  std::vector<Index> places;
  for (std::size_t k = 0; k < stays_.size(); ++k)
    if (!stays_[k] && !(degrees && degrees[k])) places.push_back(static_cast<Index>(k));
  return places;
}

template <class T> std::vector<T> RowMove::spread(std::span<const T> values, int components) const
{
  static_assert(sizeof(T) == sizeof(double));
  std::vector<T> carried(wanted_ * static_cast<std::size_t>(components), T{});
  for (const Run& run : runs_)
    std::copy_n(values.begin() + std::ptrdiff_t{run.from} * components, std::ptrdiff_t{run.length} * components,
                carried.begin() + std::ptrdiff_t{run.to} * components);
  if (!sf_.get()) return carried;
  const MPI_Datatype type = block_type(components); // eight bytes each, copied and never looked at
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
