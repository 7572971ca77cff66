#include "pdx/options/region_options.hpp"

#include "pdx/base/shown.hpp"
#include "pdx/mesh/gmsh.hpp"
#include "pdx/options/polygon.hpp"
#include "pdx/options/scene_options.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pdx::options {
namespace region_options {
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSamePoisson = 1e-12;

std::vector<geom::Outline::Edge> read_box(Options& o, const std::string& name)
{
  const std::vector<double> v =
      o.reals(name, {}, o.given(name) ? 4 : 0, "m", "a box x0,y0,x1,y1; what is on its border may be in or out");
  if (v.empty()) return {};
  if (!(v[0] < v[2] && v[1] < v[3]))
    throw UserError(
        fmt::format("{} is {},{},{},{}: must be x0,y0,x1,y1 with x0 < x1 and y0 < y1", name, v[0], v[1], v[2], v[3]));
  return geom::Outline::edges_of({{v[0], v[1]}, {v[2], v[3]}});
}

std::vector<geom::Outline::Edge> read_border(Options& o, const std::string& stem, bool describe)
{
  std::vector<geom::Outline::Edge> box = read_box(o, stem + "_box"), polygon = read_polygon(o, stem + "_polygon");
  const std::string surface = o.text(stem + "_surface", "", "a physical surface of -mesh_file");
  if (describe) return {};
  const auto given = [&](const char* what) { return static_cast<int>(o.given(stem + what)); };
  if (given("_box") + given("_polygon") + given("_surface") != 1)
    throw UserError(fmt::format("{0}: a region needs one shape: give one of {0}_box, {0}_polygon, {0}_surface", stem));
  if (!box.empty()) return box;
  if (!polygon.empty()) return polygon;
  const std::string file = o.text("-mesh_file", "", "");
  if (file.empty())
    throw UserError(
        fmt::format("{0}_surface is of a -mesh_file, and there is none: give {0}_box or {0}_polygon", stem));
  return mesh::read_gmsh_border(fmt::format("{}_surface {}: -mesh_file", stem, shown(surface)), file, surface);
}

law::Elastic read_elastic(Options& o, const std::string& stem, const Material& material, const law::Elastic& rest,
                          bool particles, bool describe)
{
  law::Elastic elastic = rest;
  elastic.young = o.real(stem + "_young", material.young.value_or(rest.young), "Pa",
                         "Young's modulus; usually -material_young", Range::positive());
  const double poisson = particles ? rest.poisson : material.poisson.value_or(rest.poisson);
  elastic.poisson =
      o.real(stem + "_poisson", poisson, "-", "Poisson's ratio; with particles that of bonds", {-0.999, 0.4999});
  elastic.density = o.real(stem + "_density", material.density.value_or(rest.density), "kg/m^3",
                           "mass density; usually -material_density", Range::positive());
  elastic.thickness = o.real(stem + "_thickness", rest.thickness, "m",
                             "thickness of a plate there; usually -material_thickness", Range::positive());
  if (!describe && particles && std::abs(elastic.poisson - rest.poisson) > kSamePoisson)
    throw UserError(fmt::format("{}_poisson is {}: with particles it must be that of bonds, {:.6g}; drop it", stem,
                                elastic.poisson, rest.poisson));
  return elastic;
}

std::optional<double> read_toughness(Options& o, const std::string& name, std::optional<double> usual, bool particles)
{
  const double value = o.real(name, particles ? usual.value_or(kNone) : kNone, "J/m^2",
                              "energy release rate Gc; usually -material_toughness", Range::positive());
  if (std::isnan(value)) return std::nullopt;
  if (!particles) throw UserError(fmt::format("{} breaks bonds, but there are no particles: give -pd_patches", name));
  return value;
}

RegionOptions read_region(const std::string& name, const Materials& materials, const law::Elastic& rest, bool particles,
                          bool describe)
{
  Options o("region");
  const std::string stem = "-region_" + name;
  RegionOptions region;
  region.name = name;
  region.border = read_border(o, stem, describe);
  const Material material = materials.named(stem + "_material", "a material by name, as -material");
  region.elastic = read_elastic(o, stem, material, rest, particles, describe);
  region.no_fail = o.boolean(stem + "_no_fail", false, "no bond with an end in the region breaks");
  region.toughness = read_toughness(o, stem + "_toughness", material.toughness, particles);
  if (region.no_fail && o.given(stem + "_toughness"))
    throw UserError(fmt::format("{0}_toughness says when bonds break, and {0}_no_fail that none does: drop one", stem));
  return region;
}

std::size_t number_of_region(const std::string& option, const std::string& name, std::span<const RegionOptions> regions)
{
  if (name == kRest) return 0;
  const auto found = std::ranges::find(regions, name, &RegionOptions::name);
  if (found != regions.end()) return static_cast<std::size_t>(found - regions.begin()) + 1;
  std::vector<std::string> names;
  for (const RegionOptions& region : regions) names.push_back(region.name);
  throw UserError(fmt::format("{}: there is no region {}: there are {} and {}", option, shown(name),
                              fmt::join(names, ", "), kRest));
}

law::Interface read_interface(const std::string& name, std::span<const RegionOptions> regions, bool particles,
                              bool describe)
{
  Options o("region");
  const std::string between = fmt::format("-interface_{}_between", name),
                    toughness = fmt::format("-interface_{}_toughness", name);
  const std::vector<std::string> pair =
      o.texts(between, {}, "the two regions it is between; rest is what lies in none");
  const std::optional<double> gc = read_toughness(o, toughness, std::nullopt, particles || describe);
  if (describe) return {};
  if (pair.size() != 2 || pair[0] == pair[1])
    throw UserError(fmt::format("{} must name two regions, of -region_names or {}", between, kRest));
  if (!gc) throw UserError(fmt::format("{} is missing: give the energy release rate in J/m^2", toughness));
  return {number_of_region(between, pair[0], regions), number_of_region(between, pair[1], regions), *gc};
}

std::vector<std::string> names_of(Options& o, const char* option, const char* help, bool describe)
{
  std::vector<std::string> names = o.texts(option, {}, help);
  if (describe) return {"NAME"};
  for (const std::string& name : names)
    if (std::ranges::count(names, name) > 1)
      throw UserError(fmt::format("{} lists {} twice: names must differ", option, name));
  return names;
}
} // namespace region_options

RegionSetOptions RegionSetOptions::read(const Materials& materials, const law::Elastic& rest, bool particles,
                                        bool describe)
{
  Options o("region");
  RegionSetOptions set;
  const std::vector<std::string> names = region_options::names_of(
      o, "-region_names", "names of the regions of another material that follow; of two that overlap the later counts",
      describe);
  if (names.size() > law::Regions::kMost)
    throw UserError(fmt::format("-region_names has {} names: {} are possible", names.size(), law::Regions::kMost));
  for (const std::string& name : names) {
    if (name == kRest)
      throw UserError(fmt::format("-region_names lists {}, which is what lies in no region: take another name", kRest));
    set.regions.push_back(region_options::read_region(name, materials, rest, particles, describe));
  }
  const std::vector<std::string> interfaces =
      region_options::names_of(o, "-interface_names",
                               "names of the interfaces that follow, which break otherwise than "
                               "the regions beside them",
                               describe);
  if (!describe && names.empty() && !interfaces.empty())
    throw UserError("-interface_names are between regions, and there are none: give -region_names");
  for (const std::string& name : interfaces) {
    set.interfaces.push_back(region_options::read_interface(name, set.regions, particles, describe));
    const law::Interface& last = set.interfaces.back();
    for (std::size_t k = 0; k + 1 < set.interfaces.size(); ++k)
      if (const law::Interface& known = set.interfaces[k]; std::minmax(known.a, known.b) == std::minmax(last.a, last.b))
        throw UserError(fmt::format("-interface_{}_between names the regions of -interface_{}_between: a pair has one "
                                    "interface",
                                    name, interfaces[k]));
  }
  return set;
}

std::optional<double> RegionSetOptions::toughness() const
{
  std::optional<double> largest;
  const auto look = [&](double gc) { largest = std::max(largest.value_or(gc), gc); };
  for (const RegionOptions& region : regions)
    if (region.toughness && !region.no_fail) look(*region.toughness);
  for (const law::Interface& i : interfaces) look(i.toughness);
  return largest;
}

std::shared_ptr<const law::Regions> RegionSetOptions::settled(const geom::Frame& frame, const law::Elastic& rest,
                                                              const FractureOptions& fracture) const
{
  if (!any()) return nullptr;
  constexpr double never = std::numeric_limits<double>::infinity();
  const double reference = fracture.toughness.value_or(1.0);
  const double usual = !fracture.active() ? reference : fracture.rest_breaks ? reference : never;
  std::vector<law::Region> all;
  for (const RegionOptions& region : regions) {
    std::vector<geom::Outline::Edge> border = region.border;
    for (geom::Outline::Edge& edge : border)
      for (Vector<2>& end : edge) end = frame.inside(end);
    all.push_back({region.name, geom::Outline(std::move(border)), region.elastic,
                   region.no_fail ? never : region.toughness.value_or(usual)});
  }
  return std::make_shared<const law::Regions>(rest, usual, reference, std::move(all), interfaces);
}

void judge_regions(const SceneOptions& s)
{
  if (!s.region_set.any()) return;
  if (s.points.any())
    throw UserError("-region_names are of elements and particles: bodies of material points have -mpm_NAME_young, "
                    "-mpm_NAME_density each; drop -region_names");
  if (!s.pd.cloud.empty())
    throw UserError("-region_names: a -pd_cloud is of one material; give particles of a lattice (-pd_patches), or drop "
                    "them");
  if (s.converts())
    throw UserError("-region_names: bulk that is converted (-adapt_trigger) is of one material; give -pd_patches, or "
                    "drop them");
  for (const RegionOptions& region : s.region_set.regions)
    if (s.solid && region.elastic.thickness != s.elastic.thickness)
      throw UserError(fmt::format(
          "-region_{}_thickness is of plates: in space bodies are as thick as they are; drop it", region.name));
  if (s.fracture.critical_stretch)
    throw UserError("-pd_critical_stretch is of one material: give -material_toughness and -region_NAME_toughness");
  for (const RegionOptions& region : s.region_set.regions)
    if (s.face_mass && (region.elastic.density != s.elastic.density || region.elastic.thickness != s.elastic.thickness))
      throw UserError(fmt::format("-couple_face_mass hands over mass of one density and thickness: drop it, or "
                                  "-region_{0}_density and -region_{0}_thickness",
                                  region.name));
  for (const RegionOptions& region : s.region_set.regions)
    if (s.time.dynamic() && region.elastic.density <= 0.0)
      throw UserError(
          fmt::format("-region_{}_density is missing: things that move have a mass; give it in kg/m^3", region.name));
}

std::vector<std::string> region_warnings(const SceneOptions& s)
{
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < s.region_set.regions.size(); ++k) {
    const RegionOptions& region = s.region_set.regions[k];
    const bool named = std::ranges::any_of(s.region_set.interfaces,
                                           [k](const law::Interface& i) { return i.a == k + 1 || i.b == k + 1; });
    const bool breaks_alike = !region.toughness || (s.fracture.rest_breaks && region.toughness == s.fracture.toughness);
    if (named || !law::same(region.elastic, s.elastic) || !breaks_alike || (region.no_fail && s.fracture.active()))
      continue;
    lines.push_back(fmt::format("-region_{0} is of the same material as the rest{1} and changes nothing: give "
                                "-region_{0}_young, _density, _thickness, _toughness or _material, or drop it",
                                region.name, region.no_fail ? ", where nothing breaks," : ""));
  }
  return lines;
}
} // namespace pdx::options
