#include "pdx/options/option_names.hpp"

#include "pdx/base/given_options.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/options/scene_options.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::options {
namespace {
constexpr std::size_t kSlips = 2; // letters that are wrong in a misspelt name

/// Options that are one for each name of a list.
struct Family {
  std::string list, stem;
};
const std::vector<Family>& families()
{
  static const std::vector<Family> all{{"-bc_names", "-bc_"},         {"-crack_names", "-crack_"},
                                       {"-mpm_bodies", "-mpm_"},      {"-probe_names", "-probe_"},
                                       {"-region_names", "-region_"}, {"-interface_names", "-interface_"}};
  return all;
}

/// What stands behind the name in options of a family, with its underscore.
std::vector<std::string> endings_of(const Family& family)
{
  const std::string stem = family.stem + "NAME_";
  std::vector<std::string> endings;
  for (const OptionDoc& doc : documented_options())
    if (doc.name.starts_with(stem)) endings.push_back(doc.name.substr(stem.size() - 1));
  if (family.stem == "-crack_") endings.emplace_back("_points"); // documented only where there is none
  return endings;
}

/// The name in an option of the family, by its longest ending; "" for another option.
std::string name_in(const std::string& option, const Family& family)
{
  std::string name;
  if (!option.starts_with(family.stem)) return name;
  for (const std::string& ending : endings_of(family)) {
    if (!option.ends_with(ending) || option.size() <= family.stem.size() + ending.size()) continue;
    const std::string found = option.substr(family.stem.size(), option.size() - family.stem.size() - ending.size());
    if (name.empty() || found.size() < name.size()) name = found;
  }
  return name;
}

std::vector<std::string> unknown_options()
{
  std::vector<std::string> unknown;
  for (const auto& [name, option] : given_options())
    if (!is_documented(name) && !is_petsc_name(name)) unknown.push_back(name);
  return unknown;
}
} // namespace

void refuse_misspelt(std::string_view message)
{
  (void)SceneOptions::read(true); // what would have been read later is no misspelt name
  const std::vector<std::string> unknown = unknown_options();
  const auto in_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; };
  for (std::size_t at = message.find('-'); at < message.size(); at = message.find('-', at)) {
    const std::size_t begin = at;
    while (at < message.size() && in_name(message[at])) ++at;
    const std::string named(message.substr(begin, at - begin));
    if (named.size() < 5 || given_option(named)) continue;
    for (const std::string& name : unknown)
      if (edit_distance(name, named) <= kSlips)
        throw UserError(fmt::format("{} is no option of pdxsolve: did you mean {}?", shown(name), named));
  }
}

void refuse_unlisted()
{
  const std::vector<std::string> unknown = unknown_options();
  if (unknown.empty()) return;
  (void)SceneOptions::read(true); // the options of any NAME
  for (const std::string& option : unknown)
    for (const Family& family : families()) {
      const std::string name = name_in(option, family);
      if (name.empty()) continue;
      const std::vector<std::string> names = Options("scene").texts(family.list, {}, "");
      if (std::ranges::find(names, name) != names.end()) continue;
      const std::string nearest = nearest_option(option);
      const bool slip =
          !nearest.empty() && nearest.find("NAME") == std::string::npos && edit_distance(option, nearest) <= kSlips;
      throw UserError(
          fmt::format("{} is no option of pdxsolve: {} is not in {}{}{}", shown(option), shown(name), family.list,
                      names.empty() ? ", which is not given" : fmt::format(" ({})", fmt::join(names, ",")),
                      slip ? fmt::format("; add it there, or did you mean {}?", nearest) : ": add it there"));
    }
}
} // namespace pdx::options
