#pragma once
#include "pdx/solve/time_driver.hpp"
#include "support/scene.hpp"

namespace pdx::test {
/// A standing pressure wave of the local solid, u = sin(omega t) grad(sin(p x + 0.3) sin(q y + 0.2)), in any body whose
/// border it drives.
struct StandingWave {
  explicit StandingWave(const law::Elastic& elastic)
      : omega(std::sqrt((kP * kP + kQ * kQ) * elastic.c11() / elastic.density))
  {}
  static Vector<2> shape(const Vector<2>& x)
  {
    const double a = kP * x.x() + 0.3, b = kQ * x.y() + 0.2;
    return {kP * std::cos(a) * std::sin(b), kQ * std::sin(a) * std::cos(b)};
  }
  Field at(double time) const
  {
    return [factor = std::sin(omega * time)](const Vector<2>& x) -> Vector<2> { return factor * shape(x); };
  }
  double period() const { return 2.0 * 3.141592653589793 / omega; }

  /// Starts the scene as the wave is at time 0, and drives all that is held as it goes on, for a period.
  void drive(Scene& scene) const
  {
    field::System& system = scene.system();
    std::vector<field::History::Point> points;
    constexpr int steps = 20000; // straight in between: 1e-8 of the amplitude
    for (int k = 0; k <= steps; ++k) {
      const double time = period() * k / steps;
      points.push_back({time, std::sin(omega * time)});
    }
    scene.prescribe(shape);
    system.drives = {{field::Drive::Kind::displacement, field::History::table(std::move(points)),
                      system.prescribed.components, system.prescribed.values}};
    const std::vector<double> speed = scene.blocks(shape);
    system.initial_velocity.assign(speed.begin(), speed.begin() + 2 * scene.rows().owned());
    for (double& v : system.initial_velocity) v *= omega;
  }

  static constexpr double kP = 2.2, kQ = 1.7;
  double omega; ///< [1/s]
};

/// For runs in time.
inline options::SceneOptions moving(options::SceneOptions options,
                                    options::Analysis analysis = options::Analysis::explicit_dynamics)
{
  options.elastic.density = 1.0;
  options.time.analysis = analysis;
  return options;
}
} // namespace pdx::test
