#pragma once
#include <string>
#include <vector>

namespace pdx::field {
/// What a field shows: XDMF's attribute types. Vectors have 3 components, tensors the 6 of (xx, xy, xz, yy, yz, zz).
enum class Rank { scalar = 1, vector = 3, tensor = 6 };

/// Values of one quantity on the points or cells this rank owns, in the order of the block they belong to.
struct OutputField {
  std::string name; ///< with unit in brackets, e.g. "displacement [m]"
  Rank rank = Rank::scalar;
  bool on_cells = false;      ///< per cell instead of per point
  bool integer = false;       ///< stored as 32-bit integers
  std::vector<double> values; ///< owned points (cells) x components
};

/// One set of points (with cells, or bare particles) and its fields, as this rank owns it.
struct OutputBlock {
  std::string name;               ///< "mesh", "particles"
  std::vector<double> points;     ///< owned points x 3 [m]
  std::vector<int> natural_point; ///< rank-independent number of each owned point
  bool quadrilaterals = false;    ///< cells are four-node; otherwise every point is a vertex cell
  std::vector<int> cells;         ///< owned cells x 4, global point numbers (rank by rank in order of ranks)
  std::vector<OutputField> fields;
};
} // namespace pdx::field
