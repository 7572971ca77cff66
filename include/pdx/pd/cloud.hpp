#pragma once
#include "pdx/base/tensor.hpp"

#include <filesystem>
#include <vector>

namespace pdx::pd {
/// Particles that lie anywhere.
template <int Dim> struct Cloud {
  std::vector<Vector<Dim>> points; ///< [m]
  std::vector<double> volumes;     ///< [m^3]
  std::vector<Index> sets;         ///< a number per particle, for what belongs together; all 0 if the file has none
};

/// Reads a file of particles, alike on every rank that calls it.
/// *.csv: a first line `x,y,volume` or `x,y,volume,set` (with `z` after `y` in 3-D), then a line per particle.
/// *.h5, *.hdf5: datasets `position` [particles x Dim], `volume` and, if there is one, `set` [particles].
/// Throws UserError for a file that cannot be read, has other columns, a value that is no finite number, or a volume
/// that is not positive; it says which line or dataset.
template <int Dim> Cloud<Dim> read_cloud(const std::filesystem::path& path);
} // namespace pdx::pd
