#include "pdx/options/material_options.hpp"

#include "pdx/law/bond.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::options {
namespace {
constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
constexpr double kRounding = 1e-12; // of a ratio written in full
} // namespace

law::Elastic read_material(const Material& named, bool describe, bool& solid)
{
  Options o("material");
  law::Elastic elastic;
  static constexpr const char* planes[] = {"stress", "strain", "solid"};
  const int plane = o.choice("-material_plane", 0, planes, "plane problem, or solid: in space, as deep as thick");
  solid = plane == 2;
  elastic.plane = plane == 0 ? law::Plane::stress : law::Plane::strain; // of the moduli in space
  elastic.young =
      o.real("-material_young", named.young.value_or(kNotGiven), "Pa", "Young's modulus", Range::positive());
  elastic.poisson =
      o.real("-material_poisson", named.poisson.value_or(law::required_poisson(2, elastic.plane)), "-",
             "Poisson's ratio; with particles 1/3 (plane stress) or 1/4 (plane strain, solid), taken exactly",
             {-0.999, 0.4999});
  elastic.thickness =
      o.real("-material_thickness", 1.0, "m", "out-of-plane thickness; of a solid its depth", Range::positive());
  if (!describe && solid && !o.given("-pd_cloud") && !o.given("-mpm_bodies") && !o.given("-material_thickness"))
    throw UserError("-material_thickness is missing: give the depth of the solid in m");
  elastic.density = o.real("-material_density", named.density.value_or(0.0), "kg/m^3", "mass density; needed in time",
                           Range::positive());
  if (!describe && std::isnan(elastic.young))
    throw UserError("-material_young is missing: give Young's modulus in Pa, e.g. -material_young 1e9, or -material");
  return elastic;
}

law::Elastic of_bonds(const SceneOptions& s, const Material& named)
{
  law::Elastic elastic = s.elastic;
  if (named.poisson && !Options("material").given("-material_poisson"))
    elastic.poisson = law::required_poisson(s.solid ? 3 : 2, elastic.plane);
  return elastic;
}

void take_required_poisson(SceneOptions& s)
{
  const double required = law::required_poisson(s.solid ? 3 : 2, s.elastic.plane);
  const bool named = !Options("material").given("-material_poisson"); // and none was asked for
  if (named && std::abs(s.elastic.poisson - required) > kRounding)
    s.notes.push_back(fmt::format("Poisson's ratio of -material is {}: taken as {}, the only value that bonds can have",
                                  s.elastic.poisson, s.elastic.plane == law::Plane::stress ? "1/3" : "1/4"));
  if (!named && std::abs(s.elastic.poisson - required) > kRounding)
    s.warnings.push_back(fmt::format("-material_poisson is {}: taken as {}, the only value that bonds can have",
                                     s.elastic.poisson, s.elastic.plane == law::Plane::stress ? "1/3" : "1/4"));
  s.elastic.poisson = required;
}
} // namespace pdx::options
