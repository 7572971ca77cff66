#include "pdx/app/apply_conditions.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

namespace pdx::app {
void require_support(const field::System& system)
{
  const auto& x = system.coordinates;
  Vector<2> lower = Vector<2>::Constant(std::numeric_limits<double>::max()), upper = -lower;
  for (std::size_t k = 0; k + 1 < x.size(); k += 2) {
    lower = lower.cwiseMin(Vector<2>(x[k], x[k + 1]));
    upper = upper.cwiseMax(Vector<2>(x[k], x[k + 1]));
  }
  MPI_Allreduce(MPI_IN_PLACE, lower.data(), 2, MPI_DOUBLE, MPI_MIN, system.rows.comm);
  MPI_Allreduce(MPI_IN_PLACE, upper.data(), 2, MPI_DOUBLE, MPI_MAX, system.rows.comm);
  const Vector<2> centre = 0.5 * (lower + upper);
  const double size = 0.5 * (upper - lower).norm();

  // How strongly the held components resist each rigid motion: translations along x and y, rotation.
  Eigen::Matrix3d resistance = Eigen::Matrix3d::Zero();
  for (const Index component : system.prescribed.components) {
    const auto row = static_cast<std::size_t>(component / 2);
    const Vector<2> r = (Vector<2>(x[2 * row], x[2 * row + 1]) - centre) / size;
    const Eigen::Vector3d motion = component % 2 ? Eigen::Vector3d(0.0, 1.0, r[0]) : Eigen::Vector3d(1.0, 0.0, -r[1]);
    resistance += motion * motion.transpose();
  }
  MPI_Allreduce(MPI_IN_PLACE, resistance.data(), 9, MPI_DOUBLE, MPI_SUM, system.rows.comm);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> modes(resistance);
  if (modes.eigenvalues()[0] > 1e-10 * std::max(1.0, modes.eigenvalues()[2])) return;
  const Eigen::Vector3d free = modes.eigenvectors().col(0).cwiseAbs();
  const char* motion = free[2] > 1e-3 ? "rotate" : free[0] > free[1] ? "slide along x" : "slide along y";
  throw UserError(
      fmt::format("the body can {}: the -bc_..._displacement conditions must hold all rigid motions", motion));
}
} // namespace pdx::app
