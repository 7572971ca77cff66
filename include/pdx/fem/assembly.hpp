#pragma once
#include "pdx/fem/element.hpp"
#include "pdx/fem/shape.hpp"
#include "pdx/field/block_adder.hpp"
#include "pdx/law/regions.hpp"
#include "pdx/mesh/mesh.hpp"

#include <optional>

namespace pdx::fem {
/// An elastic solid on a mesh; borrows the mesh and the regions.
struct ElasticBody {
  const mesh::Mesh& mesh;
  law::Elastic law;
  Kinematics kinematics = Kinematics::small;
  const law::Regions* regions = nullptr; ///< of other materials; null: all is of `law`

  std::size_t laws() const { return regions ? regions->count() : 1; }
  /// Number of a cell's law: of the region that holds its middle.
  std::size_t number(Index cell) const { return regions ? regions->at(mesh.centroid(cell)) : 0; }
  const law::Elastic& law_of(Index cell) const { return regions ? regions->elastic(number(cell)) : law; }
};

/// Small-strain stiffness of cell after cell, integrated again only when the shape of the cell changes: once for a
/// uniform mesh. Shapes are equal if the corners' offsets agree to 1e-12 of the cell's size and to the rounding of
/// the coordinates.
class ReusedStiffness {
public:
  explicit ReusedStiffness(const law::Elastic& law) : law_(law) {}
  const ElementMatrix& of(const Corners& corners);
  int integrations() const { return integrations_; } ///< matrices integrated so far [-]

private:
  law::Elastic law_;
  std::optional<Corners> last_;
  ElementMatrix matrix_;
  int integrations_ = 0;
};
/// One for each law of a body.
std::vector<ReusedStiffness> reused_stiffness(const ElasticBody& body);

/// Counts the couplings of owned rows through the listed cells, each neighbour once.
/// @param local_rows as for `assemble_stiffness`
void count_couplings(const mesh::Mesh& mesh, std::span<const Index> cells, std::span<const Index> local_rows,
                     field::Couplings& couplings);

/// Adds the tangents [N/m] of the listed local cells, of whatever use, at the given displacement.
/// @param local_rows local row (of the adder's halo) of every local vertex; read at the vertices of the cells only
/// @param displacement 2 per local vertex [m]; empty for the undeformed body
void assemble_stiffness(const ElasticBody& body, std::span<const Index> cells, std::span<const Index> local_rows,
                        std::span<const double> displacement, field::BlockAdder& adder);
} // namespace pdx::fem
