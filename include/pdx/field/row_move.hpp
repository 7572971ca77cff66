#pragma once
#include "pdx/base/petsc.hpp"
#include "pdx/field/row_name.hpp"

#include <span>
#include <vector>

namespace pdx::field {
/// Where the rows of one layout are in another, on whatever ranks both have them: by this restart, a change of layout
/// and rebalancing carry what a scene knows.
class RowMove {
public:
  enum class Wanted {
    often, ///< any name by any rank, as often as it likes
    known, ///< the same, of a `from` that is known to have each name once
    once   ///< by one rank at most, and `from` is known to have it once: mostly it is where it was
  };
  /// @param from rows that this rank has values of, each named once on all ranks; RowName() for none
  /// @param to   rows that this rank wants. Collective.
  RowMove(MPI_Comm comm, std::span<const RowName> from, std::span<const RowName> to, Wanted wanted = Wanted::often);

  /// No name of `from` came twice, on all ranks; true where it is not looked at, because names are wanted once.
  bool unique() const { return unique_; }
  std::span<const Index> fresh() const { return fresh_; } ///< places in `to` of what `from` has not, ascending
  /// Places in `from` that no rank wants, ascending. Collective.
  std::vector<Index> left_behind() const;
  /// Values of `to`, 0 where fresh. Collective.
  /// @param values of `from` x components
  std::vector<double> carry(std::span<const double> values, int components) const;
  std::vector<std::uint64_t> carry(std::span<const std::uint64_t> values, int components) const;

private:
  /// Rows that follow each other in both layouts, on this rank.
  struct Run {
    Index from, to, length;
  };
  std::vector<Index> find_here(std::span<const RowName> from, std::span<const RowName> to);
  void find_anywhere(MPI_Comm comm, std::vector<std::uint64_t> from, std::span<const RowName> to,
                     std::span<const Index> places);
  template <class T> std::vector<T> spread(std::span<const T> values, int components) const;

  std::size_t wanted_ = 0;
  std::vector<std::uint8_t> stays_; // per place in `from`: in a run
  std::vector<Run> runs_;
  SfHandle sf_; // of what is in no run; null: nothing
  std::vector<Index> fresh_;
  bool unique_ = true;
};
} // namespace pdx::field
