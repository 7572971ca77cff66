#include "pdx/scene/mixed_points.hpp"
#include "pdx/scene/point_body.hpp"

#include <algorithm>

namespace pdx::scene {
namespace {
/// Bodies of points beside elements and particles: their rows are nodes of the mesh.
class MixedPart final : public Part {
public:
  MixedPart(const mesh::Mesh& mesh, const Discretisation& d) : mesh_(mesh), d_(d), plan_(*d.point_plan) {}

  void add_energies(std::span<const double> local, post::Energies& mine) const override
  {
    if (d_.points) mine.points += d_.points->energy(local);
  }
  bool is_of_points() const override { return true; }
  double own_kinetic(std::span<const double> velocity) const override
  {
    return d_.bodies->kinetic(velocity, d_.system.rows.nodes, plan_.elements());
  }

  /// Those that no patch covers.
  void add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const override
  {
    if (!d_.points) return;
    std::vector<double> velocity;
    d_.system.halo->fetch(now.velocity, 2, velocity);
    const auto uncovered = [this](const CellOfBody<2>& cell) {
      const mpm::Body<2>& of = plan_.bodies[static_cast<std::size_t>(cell.body)];
      const Vector<2> middle = of.node(cell.at).array() + 0.5 * of.cell_size();
      return std::ranges::none_of(d_.patch_plan->shapes, [&](const couple::PatchShape& shape) {
        return shape.body == cell.body && shape.holds(middle);
      });
    };
    int rank = 0;
    MPI_Comm_rank(mesh_.comm(), &rank);
    blocks.push_back(point_block<2>(plan_, d_.point_cells, *d_.points, now.local, velocity, rank, uncovered));
  }

  void add_columns(std::vector<io::Column>& columns) const override
  {
    columns.push_back({"points", "-"});
    for (io::Column& column : d_.bodies->more_columns()) columns.push_back(std::move(column));
  }
  void add_row(std::span<const double> local, std::span<const double> velocity, std::vector<double>& row) const override
  {
    row.push_back(static_cast<double>(d_.material_points));
    d_.bodies->add_more(local, velocity, row);
  }

  Tiles cells() const override
  {
    return d_.points ? Tiles{d_.points->cells_computed(), d_.points->cells_skipped()} : Tiles{};
  }
  bool works_in(const field::Term& term) const override { return &term == d_.points; }
  void add_shares(std::vector<double>& cells) const override
  {
    if (d_.points) add_point_shares(plan_, mesh_, cells);
  }

private:
  const mesh::Mesh& mesh_;
  const Discretisation& d_;
  const PointPlan<2>& plan_;
};
} // namespace

std::unique_ptr<Part> mixed_part(const mesh::Mesh& mesh, const Discretisation& d)
{
  return std::make_unique<MixedPart>(mesh, d);
}
} // namespace pdx::scene
