#include "pdx/options/thermal_options.hpp"

#include "pdx/base/shown.hpp"
#include "pdx/base/text_file.hpp"
#include "pdx/options/scene_options.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::options {
namespace thermal {
constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kSides[] = {"left", "right", "bottom", "top"};

/// A time [s], a place x y [m] and a temperature a line, of every point of a grid once, in any order.
std::shared_ptr<const law::TemperatureTable> read_table(const std::string& name)
{
  TextFile file("-thermal_file", name);
  std::vector<std::array<double, 4>> rows;
  auto table = std::make_shared<law::TemperatureTable>();
  while (file.next()) {
    const std::vector<std::string_view> words = words_of(file.line());
    if (words.empty()) continue;
    if (words.size() != 4)
      file.refuse(fmt::format("has {} item{}: must be a time in s, a place x y in m, and a temperature", words.size(),
                              words.size() == 1 ? "" : "s"));
    auto& row = rows.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) row[k] = file.real(words[k]);
  }
  if (rows.empty()) throw UserError(fmt::format("-thermal_file is {}: has no line", shown_path(name)));
  std::ranges::sort(rows);
  for (std::size_t k = 0; k < 3; ++k) {
    std::vector<double>& axis = table->axes[k];
    for (const auto& row : rows) axis.push_back(row[k]);
    std::ranges::sort(axis);
    axis.erase(std::unique(axis.begin(), axis.end()), axis.end());
  }
  const auto& [times, xs, ys] = table->axes;
  if (rows.size() != times.size() * xs.size() * ys.size())
    throw UserError(fmt::format(
        "-thermal_file is {}: has {} points, but its {} times, {} x and {} y make a grid of {}: "
        "must have each of these once",
        shown_path(name), rows.size(), times.size(), xs.size(), ys.size(), times.size() * xs.size() * ys.size()));
  for (auto row = rows.begin(); const double t : times)
    for (const double x : xs)
      for (const double y : ys) {
        if ((*row)[0] != t || (*row)[1] != x || (*row)[2] != y)
          throw UserError(fmt::format("-thermal_file is {}: has no point at time {:g}, x {:g}, y {:g} of its grid, and "
                                      "another twice",
                                      shown_path(name), t, x, y));
        table->values.push_back((*row++)[3]);
      }
  return table;
}

std::array<bool, 4> read_sides(Options& o)
{
  std::array<bool, 4> cooled{};
  for (const std::string& word :
       o.texts("-thermal_sides", {}, "quench: sides that are cooled, of left, right, bottom, top")) {
    const auto* const side = std::ranges::find(kSides, word);
    if (side == std::end(kSides))
      throw UserError(fmt::format("-thermal_sides has \"{}\": must be of left, right, bottom, top", shown(word)));
    cooled[static_cast<std::size_t>(side - std::begin(kSides))] = true;
  }
  return cooled;
}

void require(const Options& o, const char* field, const char* name, const char* what)
{
  if (!o.given(name)) throw UserError(fmt::format("{} is missing: -thermal_field {} needs {}", name, field, what));
}

/// What the field does not know of.
void refuse_strange(const Options& o, ThermalField field)
{
  static constexpr const char* of_quench[] = {"-thermal_conductivity", "-thermal_capacity", "-thermal_transfer",
                                              "-thermal_sides"};
  for (const char* name : of_quench)
    if (field != ThermalField::quench && o.given(name))
      throw UserError(fmt::format("{} is of -thermal_field quench: give that, or drop it", name));
  for (const char* name : {"-thermal_duration", "-thermal_pace"})
    if (field != ThermalField::quench && field != ThermalField::file && o.given(name))
      throw UserError(fmt::format("{} is of -thermal_field quench or file: give one of them, or drop it", name));
  if (field != ThermalField::file && o.given("-thermal_file"))
    throw UserError("-thermal_file is of -thermal_field file: give that, or drop it");
  if (field == ThermalField::file && o.given("-thermal_ambient"))
    throw UserError("-thermal_ambient is of -thermal_field quench or uniform: give one of them, or drop it");
  for (const char* name : {"-thermal_initial", "-thermal_ambient", "-material_expansion"})
    if (field == ThermalField::none && o.given(name))
      throw UserError(fmt::format("{} does nothing without temperatures: give -thermal_field, or drop it", name));
}

void require_all(const Options& o, const ThermalOptions& t)
{
  if (!t.active()) return;
  const bool quench = t.field == ThermalField::quench, file = t.field == ThermalField::file;
  const char* const field = quench ? "quench" : file ? "file" : "uniform";
  require(o, field, "-material_expansion", "the linear expansion of the material in 1/K, e.g. 7.5e-6");
  require(o, field, "-thermal_initial", "the temperature without stress");
  if (!file)
    require(o, field, "-thermal_ambient", quench ? "the temperature of the medium" : "the temperature at load 1");
  if (quench || file) require(o, field, "-thermal_duration", "the time at load 1 in s");
  if (file) require(o, field, "-thermal_file", "a table of times, places and temperatures");
  if (!quench) return;
  require(o, field, "-thermal_conductivity", "that of heat in W/(m K)");
  require(o, field, "-thermal_capacity", "that of heat in J/(kg K)");
  require(o, field, "-thermal_sides", "the sides that are cooled, e.g. left,bottom");
  require(o, field, "-material_density", "a mass density in kg/m^3, for the heat the body holds");
}
} // namespace thermal

ThermalOptions ThermalOptions::read(bool describe)
{
  using namespace thermal;
  Options o("thermal");
  ThermalOptions t;
  static constexpr const char* fields[] = {"none", "uniform", "quench", "file"};
  static constexpr const char* paces[] = {"even", "square"};
  t.expansion = o.real("-material_expansion", kNotGiven, "1/K", "linear thermal expansion", Range::positive());
  t.field = static_cast<ThermalField>(o.choice(
      "-thermal_field", 0, fields, "temperatures: alike everywhere, a rectangle cooled from its sides, or a table"));
  t.initial =
      o.real("-thermal_initial", kNotGiven, "K", "temperature at first, without stress; all in K or all in Celsius");
  t.ambient = o.real("-thermal_ambient", kNotGiven, "K", "temperature of the cooling medium; uniform: at load 1");
  t.conductivity =
      o.real("-thermal_conductivity", kNotGiven, "W/m/K", "quench: conductivity of heat", Range::positive());
  t.capacity = o.real("-thermal_capacity", kNotGiven, "J/kg/K", "quench: heat capacity", Range::positive());
  const double transfer = o.real("-thermal_transfer", kNotGiven, "W/m^2/K",
                                 "quench: heat through a cooled side per degree; without it that takes on the "
                                 "medium's temperature at once",
                                 Range::positive());
  if (!std::isnan(transfer)) t.transfer = transfer;
  t.cooled = read_sides(o);
  t.duration =
      o.real("-thermal_duration", kNotGiven, "s", "time of the cooling, or of the table, at load 1", Range::positive());
  t.square = o.choice("-thermal_pace", 0, paces, "how this time grows with the load: evenly, or with its square") == 1;
  const std::string file =
      o.text("-thermal_file", "", "table of temperatures: time [s] x y [m] temperature a line, on a grid");
  if (describe) return t;
  refuse_strange(o, t.field);
  require_all(o, t);
  if (t.field == ThermalField::file) t.table = read_table(file);
  return t;
}

void judge_thermal(const SceneOptions& s)
{
  if (!s.thermal.active()) return;
  const auto refuse = [](bool wrong, const char* why) {
    if (wrong) throw UserError(fmt::format("-thermal_field {}", why));
  };
  refuse(s.points.any(),
         "strains elements and particles of a lattice, and there are material points: drop -mpm_bodies");
  refuse(!s.pd.cloud.empty(), "strains elements and particles of a lattice: drop -pd_cloud");
  refuse(s.solid, "is of the plane: give -material_plane stress or strain");
  refuse(s.time.dynamic(), "acts in load steps, as equilibria while the body cools: give -analysis static");
  refuse(s.kinematics == KinematicsOption::finite, "strains linear elements: give -kinematics small or mixed");
  refuse(s.post.any_j(), "cannot stand beside -post_j_... and -post_energy_release: J does not know the free strain");
  refuse(s.region_set.any(), "is of one material: drop -region_names");
  refuse(s.layout.adapt == Adapt::relocate, "cannot stand beside -adapt relocate: give -adapt expand or none");
  refuse(s.thermal.field == ThermalField::quench && !s.mesh.file.empty(),
         "quench cools a rectangle: give -mesh_lower and -mesh_upper instead of -mesh_file, or -thermal_field file");
}
} // namespace pdx::options
