#include "pdx/io/hdf5_slab.hpp"

#include <array>

namespace pdx::io {
namespace {
herr_t keep_deepest(unsigned, const H5E_error2_t* error, void* text)
{
  std::string& reason = *static_cast<std::string*>(text);
  if (reason.empty() && error->desc) reason = error->desc;
  return 0;
}

hid_t table(hsize_t rows, hsize_t columns)
{
  const std::array<hsize_t, 2> extent{rows, columns};
  return H5Screate_simple(2, extent.data(), nullptr);
}
} // namespace

std::string hdf5_reason()
{
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_deepest, &reason);
  return reason.empty() ? "HDF5 gives no reason" : reason;
}

Hdf5Slab::Hdf5Slab(hid_t dataset, hsize_t first, hsize_t rows, hsize_t columns)
    : in_file(H5Dget_space(dataset), H5Sclose), in_memory(table(rows, columns), H5Sclose),
      transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose)
{
  const std::array<hsize_t, 2> start{first, 0}, count{rows, columns};
  if (rows)
    H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  else {
    H5Sselect_none(in_file);
    H5Sselect_none(in_memory);
  }
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
}
} // namespace pdx::io
