#include "pdx/xfem/cut_output.hpp"

#include "pdx/geom/polygon.hpp"
#include "pdx/mesh/locate.hpp"

namespace pdx::xfem {
namespace {
constexpr int kPointsOfPieces = 128; // numbers for those of a cell

/// Displacement of the corners as one side sees them, a column each [m].
using CornerValues = Eigen::Matrix<double, 2, 4>;

geom::Polygon part_of(const CutElement& cut, const fem::Corners& corners, Side side)
{
  if (cut.snapped) return *cut.snapped == side ? geom::Polygon(corners.begin(), corners.end()) : geom::Polygon{};
  geom::Split parts = geom::split(corners, cut.distance);
  return side == Side::plus ? std::move(parts.plus) : std::move(parts.minus);
}

/// What a cut cell is drawn as on a side: one outline, or those of a piece.
std::vector<geom::Polygon> outlines_of(const CutElement& cut, const fem::Corners& corners, Side side)
{
  if (!cut.piece) return {part_of(cut, corners, side)};
  return side == Side::plus ? cut.piece->outlines : std::vector<geom::Polygon>{};
}

/// A polygon as four-node cells around its first corner.
void add_fan(int first, int corners, std::vector<int>& cells)
{
  for (int k = 1; k + 1 < corners; k += 2)
    cells.insert(cells.end(), {first, first + k, first + k + 1, first + std::min(k + 2, corners - 1)});
}
} // namespace

field::OutputBlock cut_block(const mesh::Mesh& mesh, const EnrichedSets& sets, std::span<const PetscInt> node_rows,
                             const field::RowHalo& halo, std::span<const double> u)
{
  const auto block_of = [&](PetscInt row) -> Vector<2> {
    const auto at = 2 * static_cast<std::size_t>(halo.local(row));
    return {u[at], u[at + 1]};
  };
  const auto corner_values = [&](const CutElement& cut, Side side) {
    CornerValues values;
    for (std::size_t a = 0; a < 4; ++a) {
      Vector<2> value = block_of(node_rows[static_cast<std::size_t>(mesh.cell(cut.cell)[a])]);
      if (cut.sets[a] >= 0) value += set_factor(cut, a, side) * block_of(cut.sets[a]);
      values.col(static_cast<Index>(a)) = value;
    }
    return values;
  };

  field::OutputBlock block;
  block.name = "cut_cells";
  block.quadrilaterals = true;
  field::OutputField displacement{"displacement [m]", field::Rank::vector, false, false, {}},
      sides{"side", field::Rank::scalar, false, true, {}};
  int piece = 0, piece_point = 0; // of the cell
  for (std::size_t c = 0; c < sets.cells().size(); ++c) {
    const CutElement& cut = sets.cells()[c];
    if (cut.cell >= mesh.owned_cells()) continue;
    const bool same_cell = c > 0 && sets.cells()[c - 1].cell == cut.cell;
    piece = same_cell ? piece + 1 : 0;
    piece_point = same_cell ? piece_point : 0;
    const fem::Corners corners = mesh.corners(cut.cell);
    for (const Side side : kSides) {
      const CornerValues values = corner_values(cut, side);
      for (const geom::Polygon& part : outlines_of(cut, corners, side)) {
        add_fan(static_cast<int>(block.natural_point.size()), static_cast<int>(part.size()), block.cells);
        for (std::size_t k = 0; k < part.size(); ++k) {
          const std::array<double, 4> weights = mesh::bilinear_weights(corners, part[k]);
          const Vector<2> d = values * Eigen::Map<const Eigen::Vector4d>(weights.data());
          block.points.insert(block.points.end(), {part[k].x(), part[k].y(), 0.0});
          displacement.values.insert(displacement.values.end(), {d.x(), d.y(), 0.0});
          sides.values.push_back(!cut.piece ? step(side) : cut.piece->side ? step(*cut.piece->side) : 2.0 + piece);
          block.natural_point.push_back(
              cut.piece ? 16 * mesh.global_cells() + kPointsOfPieces * mesh.natural_cell(cut.cell) + piece_point++
                        : 16 * mesh.natural_cell(cut.cell) + (side == Side::plus ? 8 : 0) + static_cast<int>(k));
        }
      }
    }
  }
  const auto points = static_cast<Index>(block.natural_point.size());
  const PetscInt first = field::Rows::number(mesh.comm(), 1, points, 0, 0).first;
  for (int& corner : block.cells) corner += first;
  block.fields.push_back(std::move(displacement));
  block.fields.push_back(std::move(sides));
  return block;
}
} // namespace pdx::xfem
