#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pdx::io {
/// One field as XDMF describes it; its values lie in `group`/`dataset` of the grid it belongs to.
struct XdmfAttribute {
  std::string name;    ///< shown to the reader, with its unit
  std::string dataset; ///< name inside the grid's group
  int components = 1;  ///< 1 scalar, 3 vector, 6 symmetric tensor
  bool on_cells = false;
  bool integer = false;
};

/// One set of points and cells: datasets `points` [points x 3] and `cells` [cells x 4, or x 1 for bare points].
struct XdmfGrid {
  std::string name;  ///< "mesh", "particles"
  std::string group; ///< "/step000000/mesh"
  std::int64_t points = 0, cells = 0;
  bool quadrilaterals = false;
  std::vector<XdmfAttribute> attributes;
};

/// The entry of one time in the temporal collection: a spatial collection of its grids.
/// Grids without points or cells are left out, ParaView's readers refuse them; "" if none is left.
/// @param data_file name of the HDF5 file, relative to the XDMF file
std::string xdmf_step(std::string_view data_file, double time, std::span<const XdmfGrid> grids);
/// The entries of the first steps of a document, all if it has no more.
std::string xdmf_first_steps(std::string_view document, int steps);
/// The whole document around the entries of all steps.
std::string xdmf_document(std::string_view steps);
} // namespace pdx::io
