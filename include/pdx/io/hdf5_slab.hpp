#pragma once
#include "pdx/base/hdf5_id.hpp"

#include <string>

namespace pdx::io {
/// What HDF5 says about its last failed call.
std::string hdf5_reason();

/// This rank's share of an H5Dread or H5Dwrite that all ranks make together: whole rows of a table, maybe none.
struct Hdf5Slab {
  /// @param first first row of this rank in `dataset`
  Hdf5Slab(hid_t dataset, hsize_t first, hsize_t rows, hsize_t columns);

  Hdf5Id in_file, in_memory; ///< the rows in the dataset, and as they lie here, one after the other
  Hdf5Id transfer;           ///< property list of the collective call
};
} // namespace pdx::io
