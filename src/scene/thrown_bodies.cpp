#include "pdx/scene/thrown_bodies.hpp"

#include <algorithm>

namespace pdx::scene {
namespace thrown {
template <int Dim> Vector<Dim> turned(const Vector<3>& spin, const Vector<Dim>& arm)
{
  Vector<3> x = Vector<3>::Zero();
  x.head<Dim>() = arm;
  return spin.cross(x).template head<Dim>();
}
} // namespace thrown

template <int Dim>
void throw_bodies(const options::PointOptions& options, const PointPlan<Dim>& plan, std::span<const Index> body,
                  field::System& system)
{
  const auto rests = [](const options::PointBodyOptions& of) { return of.velocity.isZero(0.0) && of.spin.isZero(0.0); };
  if (std::ranges::all_of(options.bodies, rests)) return;
  std::vector<Vector<Dim>> centre;
  for (const mpm::Body<Dim>& of : plan.bodies) centre.push_back(of.centre());
  system.initial_velocity.resize(Dim * body.size(), 0.0);
  for (std::size_t row = 0; row < body.size(); ++row) {
    const auto b = static_cast<std::size_t>(body[row]);
    if (b >= centre.size()) continue;
    const Vector<Dim> x = Eigen::Map<const Vector<Dim>>(&system.coordinates[Dim * row]);
    Eigen::Map<Vector<Dim>>(&system.initial_velocity[Dim * row]) =
        options.bodies[b].velocity.template head<Dim>() + thrown::turned<Dim>(options.bodies[b].spin, x - centre[b]);
  }
}

template void throw_bodies<2>(const options::PointOptions&, const PointPlan<2>&, std::span<const Index>,
                              field::System&);
template void throw_bodies<3>(const options::PointOptions&, const PointPlan<3>&, std::span<const Index>,
                              field::System&);
} // namespace pdx::scene
