#pragma once
#include "pdx/pd/cloud.hpp"

namespace pdx::pd {
/// The cloud in an HDF5 file: datasets `position`, `volume` and perhaps `set`, as they stand there. Throws UserError
/// for a file that is none, or damaged, before it asks for memory or HDF5 crashes on it.
template <int Dim> Cloud<Dim> read_cloud_hdf5(const std::filesystem::path& path);
} // namespace pdx::pd
