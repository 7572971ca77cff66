#include "pdx/adapt/space_conversion.hpp"

#include "pdx/base/gather.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pdx::adapt {
namespace space_conversion {
/// Of the corners of a unit cube, at a place in it.
Eigen::Matrix<double, 8, 3> gradients_at(const Vector<3>& x)
{
  Eigen::Matrix<double, 8, 3> gradients;
  for (int corner = 0; corner < 8; ++corner)
    for (int d = 0; d < 3; ++d) {
      double product = 1.0;
      for (int e = 0; e < 3; ++e) {
        const bool upper = corner >> e & 1;
        product *= e == d ? (upper ? 1.0 : -1.0) : (upper ? x[e] : 1.0 - x[e]);
      }
      gradients(corner, d) = product;
    }
  return gradients;
}

/// Gradients at the middles of the eight parts of a unit cube.
const std::array<Eigen::Matrix<double, 8, 3>, 8>& places()
{
  static const auto all = [] {
    std::array<Eigen::Matrix<double, 8, 3>, 8> made;
    for (int k = 0; k < 8; ++k)
      made[static_cast<std::size_t>(k)] =
          gradients_at({k & 1 ? 0.75 : 0.25, k >> 1 & 1 ? 0.75 : 0.25, k >> 2 ? 0.75 : 0.25});
    return made;
  }();
  return all;
}

Eigen::Matrix<double, 3, 8> corners_of(const std::array<Index, 8>& rows, std::span<const double> local)
{
  Eigen::Matrix<double, 3, 8> u;
  for (int a = 0; a < 8; ++a)
    u.col(a) = Eigen::Map<const Vector<3>>(&local[3 * static_cast<std::size_t>(rows[static_cast<std::size_t>(a)])]);
  return u;
}

/// Sum over directions of the largest difference along an edge, squared: no gradient in the cell has a larger square.
double largest_square(const Eigen::Matrix<double, 3, 8>& u)
{
  double sum = 0.0;
  for (int d = 0; d < 3; ++d) {
    double largest = 0.0;
    for (int a = 0; a < 8; ++a)
      if (!(a >> d & 1)) largest = std::max(largest, (u.col(a | 1 << d) - u.col(a)).squaredNorm());
    sum += largest;
  }
  return sum;
}

/// Cells in order, each once.
SpaceCells sorted(SpaceCells cells)
{
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

/// Calls visit(cell) for the cells of a body as near to one as so many cells in each direction.
template <class Visit> void for_each_near(const mpm::GridPlace<3>& of, Index margin, Visit&& visit)
{
  mpm::GridPlace<3> cell{of.body, {}};
  for (cell.at[2] = of.at[2] - margin; cell.at[2] <= of.at[2] + margin; ++cell.at[2])
    for (cell.at[1] = of.at[1] - margin; cell.at[1] <= of.at[1] + margin; ++cell.at[1])
      for (cell.at[0] = of.at[0] - margin; cell.at[0] <= of.at[0] + margin; ++cell.at[0]) visit(std::as_const(cell));
}

/// From a place to a cell of a body [m].
double distance(const mpm::Body<3>& of, const Site<3>& cell, const Vector<3>& x)
{
  const Vector<3> lower = of.node(cell), upper = lower.array() + of.cell_size();
  return (x - x.cwiseMax(lower).cwiseMin(upper)).norm();
}
} // namespace space_conversion

Vector<3> principal_strains(const Tensor<3>& h)
{
  const Tensor<3> twice = h + h.transpose() + h.transpose() * h; // C - I, whose digits small strains keep
  Eigen::SelfAdjointEigenSolver<Tensor<3>> modes;
  modes.computeDirect(twice, Eigen::EigenvaluesOnly);
  Vector<3> strains;
  for (int k = 0; k < 3; ++k) {
    const double more = modes.eigenvalues()[2 - k];
    strains[k] = more / (std::sqrt(std::max(0.0, 1.0 + more)) + 1.0);
  }
  return strains;
}

SpaceWatch::SpaceWatch(const SpaceView& scene, const ConversionRule& rule) : bodies_(scene.bodies), rule_(rule)
{
  for (const mpm::GridCell<3>& cell : scene.cells) {
    if (!scene.may_convert(cell)) continue;
    Watched watched{cell, {}};
    for (std::size_t a = 0; a < 8; ++a) watched.rows[a] = scene.halo.local(cell.rows[a]);
    cells_.push_back(watched);
  }
}

SpaceCells SpaceWatch::asking(std::span<const double> local) const
{
  SpaceCells found;
  for (const Watched& cell : cells_)
    if (asks(cell, local)) found.push_back(cell.cell);
  return found;
}

bool SpaceWatch::asks(const Watched& cell, std::span<const double> local) const
{
  const mpm::Body<3>& of = bodies_[static_cast<std::size_t>(cell.cell.body)];
  const law::Elastic& elastic = of.material.elastic;
  const double nu = elastic.poisson, lambda = elastic.young * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu = elastic.mu();
  const double h = of.cell_size();
  double least = std::numeric_limits<double>::infinity(); // displacement gradient that may be too much
  if (rule_.stretch) least = *rule_.stretch;
  if (rule_.stress) least = std::min(least, *rule_.stress / (std::sqrt(3.0) * std::max(lambda, 0.0) + 2.0 * mu));
  const Eigen::Matrix<double, 3, 8> u = space_conversion::corners_of(cell.rows, local);
  if (space_conversion::largest_square(u) < least * least * h * h) return false;
  for (const auto& gradients : space_conversion::places()) {
    const Vector<3> e = principal_strains(Tensor<3>(u * gradients / h));
    if (rule_.stretch && e[0] >= *rule_.stretch) return true;
    if (rule_.stress && lambda * e.sum() + 2.0 * mu * e[0] >= *rule_.stress) return true;
  }
  return false;
}

SpaceCells conversion(const SpaceView& scene, const SpaceWatch& watch, std::span<const double> local)
{
  const MPI_Comm comm = scene.halo.rows().comm;
  SpaceCells asking = watch.asking(local);
  if (!any_rank(comm, !asking.empty())) return {};
  asking = gather_all(comm, asking);
  SpaceCells cells;
  for (const mpm::GridPlace<3>& by : asking)
    space_conversion::for_each_near(by, watch.rule().margin, [&](const mpm::GridPlace<3>& cell) {
      if (scene.may_convert(cell)) cells.push_back(cell);
    });
  return space_conversion::sorted(std::move(cells));
}

SpaceCells expansion(const SpaceView& scene, const Reaches& reaches)
{
  struct Front {
    Index body;
    Site<3> site;
  };
  const couple::ParticleDamage all = couple::particle_damage<3>(scene.halo.rows(), scene.bonds, scene.carried);
  // Calls visit(cell) for what may become particles as near to a site as that, to rounding.
  const auto for_each_around = [&](const Front& front, double reach, auto&& visit) {
    const mpm::Body<3>& of = scene.bodies[static_cast<std::size_t>(front.body)];
    const Vector<3> x = of.place_of(front.site);
    mpm::GridPlace<3> cell{front.body, {}};
    for (std::size_t d = 0; d < 3; ++d) cell.at[d] = front.site[d] / of.material.ratio;
    space_conversion::for_each_near(cell, static_cast<Index>(reach / of.cell_size()) + 1,
                                    [&](const mpm::GridPlace<3>& near) {
                                      if (space_conversion::distance(of, near.at, x) < reach && scene.may_convert(near))
                                        visit(near);
                                    });
  };
  std::vector<Front> fronts;
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    if (all.damage[k] <= kBroken) continue;
    const couple::SpaceShape& shape = scene.shapes[static_cast<std::size_t>(scene.particles[k].patch)];
    const Front front{shape.body, shape.where.active.site(scene.particles[k].site)};
    bool near = false;
    for_each_around(front, (1.0 - kSame) * reaches.critical, [&](const mpm::GridPlace<3>&) { near = true; });
    if (near) fronts.push_back(front);
  }
  SpaceCells cells;
  for (const Front& front : gather_all(scene.halo.rows().comm, fronts))
    for_each_around(front, (1.0 - kSame) * reaches.expansion,
                    [&](const mpm::GridPlace<3>& cell) { cells.push_back(cell); });
  return space_conversion::sorted(std::move(cells));
}
} // namespace pdx::adapt
