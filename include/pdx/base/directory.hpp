#pragma once
#include "pdx/base/petsc.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace pdx {
/// Where a thing with a name is: on which rank, and at which place among its things.
struct Whereabouts {
  int rank = -1; ///< -1: nobody has it
  Index place = -1;
  bool found() const { return rank >= 0; }
};

/// Finds what has a 64-bit name from any rank. Names are spread over the ranks by their hash: a rank keeps about as
/// many entries as there are things on a rank, and no table is whole anywhere.
class Directory {
public:
  /// @param names of the things on this rank, by place; 0 is nothing. Collective.
  Directory(MPI_Comm comm, std::span<const std::uint64_t> names);
  bool unique() const { return unique_; } ///< no name twice, on all ranks
  /// Of a name that came twice, one of both. Collective.
  std::vector<Whereabouts> find(std::span<const std::uint64_t> names) const;

private:
  struct Entry {
    std::uint64_t name;
    Whereabouts at;
  };
  MPI_Comm comm_;
  std::vector<Entry> entries_; // of the names this rank keeps, ascending
  bool unique_ = true;
};
} // namespace pdx
