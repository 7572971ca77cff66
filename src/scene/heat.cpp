#include "pdx/scene/heat.hpp"

#include "pdx/law/cooling.hpp"

namespace pdx::scene {
namespace heat {
using options::ThermalField;
using options::ThermalOptions;
using AtLoad = std::function<field::FreeStrain(double load)>;

AtLoad uniform(double strain)
{
  return [strain](double load) { return [strain = load * strain](const Vector<2>&) { return strain; }; };
}

AtLoad quench(const options::SceneOptions& options, double strain)
{
  const ThermalOptions& t = options.thermal;
  const double diffusivity = t.conductivity / (options.elastic.density * t.capacity);
  auto cooling = std::make_shared<const law::Cooling>(
      law::Cooling::Data{options.mesh.box, t.cooled, diffusivity, t.conductivity, t.transfer});
  return [cooling, t, strain](double load) -> field::FreeStrain {
    return [cooling, strain, share = cooling->share(t.time(load))](const Vector<2>& x) {
      return strain * (1.0 - share(x));
    };
  };
}

AtLoad table(const options::SceneOptions& options, double expansion)
{
  return [t = options.thermal, frame = options.frame, expansion](double load) -> field::FreeStrain {
    return [t, frame, expansion, time = t.time(load)](const Vector<2>& x) {
      return expansion * (t.table->at(frame.given<2>(x), time) - t.initial);
    };
  };
}
} // namespace heat

double expansion_in_plane(const options::SceneOptions& options)
{
  const bool held = options.elastic.plane == law::Plane::strain;
  return options.thermal.expansion * (held ? 1.0 + options.elastic.poisson : 1.0);
}

std::unique_ptr<field::Swelling> swelling_of(const options::SceneOptions& options)
{
  using options::ThermalField;
  const options::ThermalOptions& t = options.thermal;
  if (!t.active()) return nullptr;
  const double expansion = expansion_in_plane(options), whole = expansion * (t.ambient - t.initial);
  auto swelling = std::make_unique<field::Swelling>();
  swelling->at_load = t.field == ThermalField::uniform  ? heat::uniform(whole)
                      : t.field == ThermalField::quench ? heat::quench(options, whole)
                                                        : heat::table(options, expansion);
  return swelling;
}

void push_temperature(const options::SceneOptions& options, const field::System& system, field::OutputBlock& block)
{
  if (!system.swelling) return;
  field::OutputField f{"temperature [K]", field::Rank::scalar, false, false, {}};
  const double expansion = expansion_in_plane(options);
  for (std::size_t k = 0; k + 2 < block.points.size(); k += 3)
    f.values.push_back(options.thermal.initial +
                       system.swelling->now({block.points[k], block.points[k + 1]}) / expansion);
  block.fields.push_back(std::move(f));
}
} // namespace pdx::scene
