#include "pdx/couple/run_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace pdx::couple {
namespace {
constexpr double kBorder = 1e-6; // of a lattice cell: so near to its border is on it

template <int Dim> PlacedBond<Dim> where_it_meets(const RunBond<Dim>& bond)
{
  const double at = bond.leaves.along + 0.5, cell = std::floor(at + kBorder);
  return {&bond, static_cast<Index>(cell), static_cast<std::int64_t>(std::floor((at - cell) * 1e6 + 0.5)),
          bond.leaves.place};
}

/// Numbers kinds of bonds. What comes after a bond is mostly what came after such a one before.
template <int Dim> class Kinds {
public:
  std::size_t number(const PlacedBond<Dim>& placed)
  {
    const RunBond<Dim>& bond = *placed.bond;
    const Kind kind(placed.tile(), bond.leaves.depth, placed.cell, bond.no_fail, bond.stretch, bond.xi[0], bond.xi[1]);
    if (!next_.empty() && *kinds_[next_[last_]] == kind) return last_ = next_[last_];
    const auto [known, fresh] = numbers_.try_emplace(kind, kinds_.size());
    if (fresh) {
      kinds_.push_back(&known->first);
      next_.push_back(known->second);
    }
    next_[last_] = known->second;
    return last_ = known->second;
  }
  /// Per number: what it is in the order of kinds.
  std::vector<std::size_t> ranks() const
  {
    std::vector<std::size_t> ranks(kinds_.size());
    std::size_t rank = 0;
    for (const auto& [kind, number] : numbers_) ranks[number] = rank++;
    return ranks;
  }

private:
  using Kind = std::tuple<std::pair<Index, Index>, Index, Index, bool, double, double, double>;
  std::map<Kind, std::size_t> numbers_; // as they were met
  std::vector<const Kind*> kinds_;
  std::vector<std::size_t> next_; // after each
  std::size_t last_ = 0;
};

/// Counts places on through all sides of a patch: those that lie alike have numbers next to each other, and their bonds
/// are in the same runs. Between sides nothing meets: each has places for its particles and for its points.
template <int Dim> std::vector<PlacedBond<Dim>> placed(std::span<const RunBond<Dim>> bonds)
{
  struct Extent {
    Index first = std::numeric_limits<Index>::max(), last = std::numeric_limits<Index>::min(), begin = 0;
  };
  std::vector<std::vector<Extent>> sides; // of each patch
  const auto side_of = [&sides](const RunBond<Dim>& bond) -> Extent& {
    return sides[static_cast<std::size_t>(bond.patch)][static_cast<std::size_t>(bond.leaves.side)];
  };
  std::vector<PlacedBond<Dim>> all;
  all.reserve(bonds.size());
  for (const RunBond<Dim>& bond : bonds) {
    const auto patch = static_cast<std::size_t>(bond.patch), number = static_cast<std::size_t>(bond.leaves.side);
    if (sides.size() <= patch) sides.resize(patch + 1);
    if (sides[patch].size() <= number) sides[patch].resize(number + 1);
    all.push_back(where_it_meets(bond));
    Extent& side = side_of(bond);
    const Index place = bond.leaves.place, there = place + all.back().cell;
    side.first = std::min({side.first, place, there});
    side.last = std::max({side.last, place, there});
  }
  for (std::vector<Extent>& of_patch : sides) {
    Index begin = 0;
    for (Extent& side : of_patch) {
      if (side.last < side.first) continue; // no bonds
      side.begin = begin;
      begin += side.last - side.first + 1;
    }
  }
  for (PlacedBond<Dim>& one : all) one.place += side_of(*one.bond).begin - side_of(*one.bond).first;
  return all;
}
} // namespace

template <int Dim> std::vector<PlacedBond<Dim>> in_order(std::span<const RunBond<Dim>> given)
{
  std::vector<PlacedBond<Dim>> bonds = placed<Dim>(given);
  Kinds<Dim> kinds;
  for (PlacedBond<Dim>& one : bonds) one.kind = kinds.number(one);
  const std::vector<std::size_t> ranks = kinds.ranks();
  std::vector<std::size_t> at(ranks.size() + 1, 0); // where each kind begins
  for (PlacedBond<Dim>& one : bonds) {
    one.kind = ranks[one.kind];
    ++at[one.kind + 1];
  }
  std::partial_sum(at.begin(), at.end(), at.begin());
  std::vector<PlacedBond<Dim>> sorted(bonds.size());
  for (const PlacedBond<Dim>& one : bonds) sorted[at[one.kind]++] = one; // behind it the next one of its kind
  const auto place = [](const PlacedBond<Dim>& one) { return std::pair(one.kind, one.place); };
  if (!std::ranges::is_sorted(sorted, {}, place)) std::ranges::stable_sort(sorted, {}, place);
  return sorted;
}

template std::vector<PlacedBond<2>> in_order<2>(std::span<const RunBond<2>>);
template std::vector<PlacedBond<3>> in_order<3>(std::span<const RunBond<3>>);
} // namespace pdx::couple
