#include "pdx/adapt/energy_trial.hpp"

#include "pdx/base/symmetric.hpp"

#include <algorithm>

namespace pdx::adapt {
std::vector<double> energy_density(const SceneView& scene, std::span<const double> local)
{
  std::vector<double> density = scene.bonds.energy_density(local);
  if (scene.carried) scene.carried->add_energy_density(local, density);
  return density;
}

namespace {
constexpr Eigen::Index kBilinear = 4; // of a bilinear field
constexpr double kTooLittle = 1e-8;   // smallest over largest eigenvalue of what says nothing

/// The bilinear displacement nearest to those of some particles.
class BilinearFit {
public:
  void add(const Vector<2>& x, const Vector<2>& u)
  {
    const Eigen::Vector4d terms = terms_at(x);
    matrix_ += terms * terms.transpose();
    right_ += terms * u.transpose();
  }
  void solve() { right_ = least_solution(matrix_, right_, kTooLittle); }
  /// d u_i / d x_j, times the unit of x.
  Tensor<2> gradient(const Vector<2>& x) const
  {
    Tensor<2> g;
    g.col(0) = (right_.row(1) + x[1] * right_.row(3)).transpose();
    g.col(1) = (right_.row(2) + x[0] * right_.row(3)).transpose();
    return g;
  }

private:
  static Eigen::Vector4d terms_at(const Vector<2>& x) { return {1.0, x[0], x[1], x[0] * x[1]}; }
  Eigen::Matrix4d matrix_ = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, kBilinear, 2> right_ = Eigen::Matrix<double, kBilinear, 2>::Zero();
};

double energy_density(const law::Elastic& elastic, law::Kinematics kinematics, const Tensor<2>& g)
{
  Tensor<2> e = 0.5 * (g + g.transpose());
  if (kinematics == law::Kinematics::finite) e += 0.5 * g.transpose() * g;
  const Eigen::Vector3d strain(e(0, 0), e(1, 1), 2.0 * e(0, 1));
  return 0.5 * strain.dot(elastic.stiffness() * strain);
}
} // namespace

EnergyTrial::EnergyTrial(const SceneView& scene, const Given& given) : scene_(scene), given_(given)
{
  for (std::size_t k = 0; k < scene.particles.size(); ++k) in_cell_[scene.particles[k].cell].push_back(k);
}

bool EnergyTrial::allows(Index cell, const crack::CrackSet& paths) const
{
  double before = 0.0, after = 0.0;
  for (const Piece& piece : pieces(cell, paths)) {
    for (const std::size_t k : piece) before += given_.density[row(k)] * volume(k);
    after += energy_of_element(piece);
  }
  return after - before <= given_.most;
}

std::vector<EnergyTrial::Piece> EnergyTrial::pieces(Index cell, const crack::CrackSet& paths) const
{
  std::vector<Piece> all;
  const auto found = in_cell_.find(cell);
  if (found == in_cell_.end()) return all;
  for (const std::size_t k : found->second) {
    const auto of = std::ranges::find_if(
        all, [&](const Piece& piece) { return !paths.cuts(scene_.particles[piece.front()].x, scene_.particles[k].x); });
    if (of == all.end())
      all.push_back({k});
    else
      of->push_back(k);
  }
  return all;
}

double EnergyTrial::energy_of_element(const Piece& piece) const
{
  const Vector<2>& origin = scene_.particles[piece.front()].x;
  const double unit = scene_.around[static_cast<std::size_t>(scene_.particles[piece.front()].patch)].shape().lattice.dx;
  const auto place = [&](std::size_t k) { return Vector<2>((scene_.particles[k].x - origin) / unit); };
  BilinearFit fit;
  for (const std::size_t k : piece)
    fit.add(place(k), {given_.displacement[2 * row(k)], given_.displacement[2 * row(k) + 1]});
  fit.solve();
  double energy = 0.0;
  for (const std::size_t k : piece)
    energy += energy_density(law_of(k), given_.kinematics, fit.gradient(place(k)) / unit) * volume(k);
  return energy;
}

const law::Elastic& EnergyTrial::law_of(std::size_t particle) const
{
  const law::Regions* regions = given_.regions;
  return regions ? regions->elastic(regions->at(scene_.particles[particle].x)) : given_.elastic;
}

double EnergyTrial::volume(std::size_t particle) const
{
  const double dx = scene_.around[static_cast<std::size_t>(scene_.particles[particle].patch)].shape().lattice.dx;
  return dx * dx * law_of(particle).thickness;
}

std::size_t EnergyTrial::row(std::size_t particle) const
{
  return static_cast<std::size_t>(scene_.halo.rows().first_particle()) + particle;
}
} // namespace pdx::adapt
