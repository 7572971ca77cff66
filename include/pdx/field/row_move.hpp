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
  /// @param from rows that this rank has values of, each named once on all ranks; RowName() for none
  /// @param to   rows that this rank wants, as often as it likes. Collective.
  RowMove(MPI_Comm comm, std::span<const RowName> from, std::span<const RowName> to);

  bool unique() const { return unique_; }                 ///< no name of `from` came twice, on all ranks
  std::span<const Index> fresh() const { return fresh_; } ///< places in `to` of what `from` has not, ascending
  /// Places in `from` that no rank wants, ascending. Collective.
  std::vector<Index> left_behind() const;
  /// Values of `to`, 0 where fresh. Collective.
  /// @param values of `from` x components
  std::vector<double> carry(std::span<const double> values, int components) const;
  std::vector<std::uint64_t> carry(std::span<const std::uint64_t> values, int components) const;

private:
  template <class T> std::vector<T> spread(std::span<const T> values, int components) const;

  SfHandle sf_;
  std::size_t wanted_ = 0;
  std::vector<Index> fresh_;
  bool unique_ = true;
};
} // namespace pdx::field
