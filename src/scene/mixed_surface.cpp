#include "mixed_surface.hpp"

#include "pdx/scene/body_contact.hpp"

#include <algorithm>

namespace pdx::scene {
namespace mixed_surface {
constexpr std::uint64_t kElements = std::uint64_t{1} << 61U, kParticles = std::uint64_t{1} << 62U; // names of points

/// Surface points of the bodies of a scene, of this rank.
class Surface {
public:
  Surface(const mesh::Mesh& mesh, const Discretisation& d, bool by_sites)
      : mesh_(mesh), d_(d), scene_{mesh, d.node_rows, d.sets.get()}
  {
    if (!d.points) return;
    const std::vector<std::uint8_t> particles = have_particles();
    points_ = surface_points<2>(*d.point_plan, d.point_cells, *d.points,
                                [&](Index body) { return by_sites || particles[static_cast<std::size_t>(body)]; });
  }

  std::vector<couple::SurfacePoint<2>> points()
  {
    add_particles();
    add_elements();
    return std::move(points_);
  }

private:
  /// Which of the bodies, on any rank?
  std::vector<std::uint8_t> have_particles() const
  {
    std::vector<std::uint8_t> have(d_.point_plan->bodies.size() + 1, 0); // that of elements last
    for (const pd::Particle& p : d_.particles) have[static_cast<std::size_t>(mesh_.body(p.cell))] = 1;
    MPI_Allreduce(MPI_IN_PLACE, have.data(), static_cast<int>(have.size()), MPI_UINT8_T, MPI_MAX, mesh_.comm());
    return have;
  }
  void add(std::uint64_t name, Index body, const Vector<2>& x, double size, const couple::Host& host)
  {
    points_.push_back({{name, body, x, size}, host});
  }

  /// Beside which the body ends.
  void add_particles()
  {
    PetscInt row = d_.system.rows.first + d_.system.rows.first_particle();
    for (const pd::Particle& p : d_.particles) {
      const couple::Surroundings& around = d_.around[static_cast<std::size_t>(p.patch)];
      const couple::PatchShape& shape = around.shape();
      const Site<2> site = shape.active.site(p.site);
      bool outer = false;
      for (std::size_t d = 0; d < 2; ++d)
        for (const Index step : {-1, 1}) {
          Site<2> beside = site;
          beside[d] += step;
          outer = outer || !around.exists(beside);
        }
      if (outer) add(kParticles | shape.names.of(site), shape.body, p.x, shape.lattice.dx, couple::Host::of_row(row));
      ++row;
    }
  }

  /// Along each edge of the border two points of half its length, as deep as they are wide: squares that fill it.
  void add_elements()
  {
    std::vector<std::uint8_t> outer(static_cast<std::size_t>(mesh_.owned_cells()), 0); // edges, a bit each
    for (const std::string& name : mesh_.boundary_names())
      for (const mesh::BoundaryEdge& edge : *mesh_.boundary(name)) {
        const Index c = edge.cell;
        if (c >= mesh_.owned_cells() || (mesh_.use(c) != mesh::Use::plain && mesh_.use(c) != mesh::Use::cut)) continue;
        for (std::size_t a = 0; a < 4; ++a)
          if (mesh_.cell(c)[a] == edge.vertices[0])
            outer[static_cast<std::size_t>(c)] |= static_cast<std::uint8_t>(1U << a);
      }
    for (Index c = 0; c < mesh_.owned_cells(); ++c) {
      const auto x = mesh_.corners(c);
      std::vector<Vector<2>> placed; // where two edges meet in a square corner they share a point
      for (std::size_t a = 0; a < 4; ++a) {
        if (!(outer[static_cast<std::size_t>(c)] >> a & 1U)) continue;
        const Vector<2> along = x[(a + 1) % 4] - x[a], inward(-along[1], along[0]);
        for (const int end : {0, 1}) {
          const Vector<2> at = x[a] + (end ? 0.75 : 0.25) * along + 0.25 * inward;
          const double size = 0.5 * along.norm();
          if (std::ranges::any_of(placed, [&](const Vector<2>& other) { return (other - at).norm() < 0.25 * size; }))
            continue;
          placed.push_back(at);
          add(kElements |
                  (8 * static_cast<std::uint64_t>(mesh_.natural_cell(c)) + 2 * a + static_cast<std::uint64_t>(end)),
              mesh_.body(c), at, size, couple::host_in_cell(scene_, c, at));
        }
      }
    }
  }

  const mesh::Mesh& mesh_;
  const Discretisation& d_;
  couple::ElementView scene_;
  std::vector<couple::SurfacePoint<2>> points_;
};
} // namespace mixed_surface

std::vector<couple::SurfacePoint<2>> surface_points(const mesh::Mesh& mesh, const Discretisation& d, bool by_sites)
{
  return mixed_surface::Surface(mesh, d, by_sites).points();
}
} // namespace pdx::scene
