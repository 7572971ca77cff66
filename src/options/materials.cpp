#include "pdx/options/materials.hpp"

#include "pdx/base/options.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/base/text_file.hpp"
#include "pdx_materials.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <functional>
#include <sstream>

namespace pdx::options {
namespace {
using Refuse = std::function<void(const std::string&)>;

std::optional<double> value_of(std::string_view word, const char* what, const char* unit, const Range& range,
                               const Refuse& refuse)
{
  if (word == "-") return std::nullopt;
  std::optional<double> value;
  try {
    value = number_of(what, std::string(word), unit);
  } catch (const UserError& wrong) {
    refuse(wrong.what());
  }
  if (!value || !(*value >= range.lower && *value <= range.upper) || (range.open_lower && *value == range.lower))
    refuse(fmt::format("\"{}\" is no {} in {}: give a number {}, or - where it is not known", shown(word), what, unit,
                       range.upper > 1.0 ? "above 0" : "between -0.999 and 0.4999"));
  return value;
}

void add_line(std::string_view line, const Refuse& refuse, std::vector<Material>& all)
{
  const std::vector<std::string_view> words = words_of(line);
  if (words.empty()) return;
  if (words.size() != 5)
    refuse(fmt::format("a material has name, young, poisson, density and toughness; here are {} words", words.size()));
  Material m;
  m.name = words[0];
  m.young = value_of(words[1], "Young's modulus", "Pa", Range::positive(), refuse);
  m.poisson = value_of(words[2], "Poisson's ratio", "-", {-0.999, 0.4999}, refuse);
  m.density = value_of(words[3], "density", "kg/m^3", Range::positive(), refuse);
  m.toughness = value_of(words[4], "toughness", "J/m^2", Range::positive(), refuse);
  if (std::ranges::find(all, m.name, &Material::name) != all.end())
    refuse(fmt::format("{} was there before: names must differ", shown(words[0])));
  all.push_back(std::move(m));
}
} // namespace

Materials Materials::read()
{
  Materials materials;
  Options o("material");
  const std::string name = o.text("-material_file", "",
                                  "file with a material a line: name young poisson density "
                                  "toughness");
  if (!name.empty()) {
    TextFile file("-material_file", name);
    while (file.next())
      add_line(
          file.line(), [&file](const std::string& why) { file.refuse(why); }, materials.all_);
  }
  std::vector<Material> ours;
  std::istringstream text(kMaterials);
  for (std::string line; std::getline(text, line);)
    add_line(
        line, [&line](const std::string& why) { throw std::logic_error(fmt::format("{}: {}", why, line)); }, ours);
  for (Material& m : ours)
    if (std::ranges::find(materials.all_, m.name, &Material::name) == materials.all_.end())
      materials.all_.push_back(std::move(m));
  return materials;
}

Material Materials::named(const std::string& option, const char* help) const
{
  const std::string name = Options("material").text(option, "", help);
  if (name.empty()) return {};
  const auto found = std::ranges::find(all_, name, &Material::name);
  if (found != all_.end()) return *found;
  std::vector<std::string> names;
  for (const Material& m : all_) names.push_back(m.name);
  const std::string& nearest =
      *std::ranges::min_element(names, {}, [&name](const std::string& other) { return edit_distance(name, other); });
  throw UserError(fmt::format("{} is {}: there are {}; did you mean {}? (or give -material_file)", option, shown(name),
                              fmt::join(names, ", "), nearest));
}
} // namespace pdx::options
