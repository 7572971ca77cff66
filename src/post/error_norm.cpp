#include "pdx/post/error_norm.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::post {
DisplacementError compare_displacement(const mesh::Mesh& mesh, std::span<const double> u,
                                       std::span<const double> reference)
{
  DisplacementError error;
  double most = 0.0; // |u_ref| that counts as 0 is judged against the largest
  for (std::size_t v = 0; v < static_cast<std::size_t>(mesh.owned_vertices()); ++v)
    most = std::max(most, std::hypot(reference[2 * v], reference[2 * v + 1]));
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, mesh.comm());

  double worst[2] = {0.0, 0.0};          // Eq. 28, vector difference
  double sums[4] = {0.0, 0.0, 0.0, 0.0}; // Eq. 28, vertices, squared difference, squared reference
  for (std::size_t v = 0; v < static_cast<std::size_t>(mesh.owned_vertices()); ++v) {
    const Vector<2> a(u[2 * v], u[2 * v + 1]), b(reference[2 * v], reference[2 * v + 1]);
    worst[1] = std::max(worst[1], (a - b).norm());
    sums[2] += (a - b).squaredNorm();
    sums[3] += b.squaredNorm();
    error.relative_percent.push_back(0.0);
    if (b.norm() <= 1e-12 * most) continue;
    const double relative = std::abs(b.norm() - a.norm()) / b.norm();
    error.relative_percent.back() = 100.0 * relative;
    worst[0] = std::max(worst[0], relative);
    sums[0] += relative;
    sums[1] += 1.0;
  }
  MPI_Allreduce(MPI_IN_PLACE, worst, 2, MPI_DOUBLE, MPI_MAX, mesh.comm());
  MPI_Allreduce(MPI_IN_PLACE, sums, 4, MPI_DOUBLE, MPI_SUM, mesh.comm());
  error.max_relative_percent = 100.0 * worst[0];
  error.mean_relative_percent = sums[1] > 0.0 ? 100.0 * sums[0] / sums[1] : 0.0;
  error.vector_l2_percent = sums[3] > 0.0 ? 100.0 * std::sqrt(sums[2] / sums[3]) : 0.0;
  error.vector_max_percent = most > 0.0 ? 100.0 * worst[1] / most : 0.0;
  return error;
}
} // namespace pdx::post
