#include "pdx/options/help.hpp"

#include "pdx/base/shown.hpp"
#include "pdx/options/scene_options.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace pdx::options {
namespace {
std::string small(std::string_view text)
{
  std::string all(text);
  std::ranges::transform(all, all.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return all;
}

bool has_all(const OptionDoc& doc, const std::string& words)
{
  const std::string text = small(doc.name + " " + doc.room + " " + doc.help + " " + doc.allowed);
  std::istringstream stream(words);
  for (std::string word; stream >> word;)
    if (text.find(word) == std::string::npos) return false;
  return true;
}

std::string described(const OptionDoc& doc)
{
  return fmt::format("  {:<28} {}{}\n{:31}default {}; {}\n", doc.name, doc.help,
                     doc.unit.empty() ? "" : " [" + doc.unit + "]", "", doc.default_value, doc.allowed);
}

const std::vector<OptionDoc>& all_options()
{
  (void)SceneOptions::read(true);
  return documented_options();
}
} // namespace

namespace {
/// Where the pages to read are, if they were installed with the program that runs.
std::string manual()
{
  namespace fs = std::filesystem;
  std::error_code none;
  const fs::path pages = fs::read_symlink("/proc/self/exe", none).parent_path().parent_path() / "share/doc/pdxsolve";
  if (!fs::exists(pages / "tutorial.md", none)) return "";
  return fmt::format("\nTo begin with: {}; cases are in {}.\n", (pages / "tutorial.md").string(),
                     (pages.parent_path().parent_path() / "pdxsolve/cases").string());
}
} // namespace

std::string help_text(std::string_view words)
{
  std::string list, room;
  const std::string wanted = small(words);
  for (const OptionDoc& doc : all_options()) {
    if (!has_all(doc, wanted)) continue;
    if (doc.room != room) list += fmt::format("\n{}\n", room = doc.room);
    list += described(doc);
  }
  if (list.empty()) {
    const std::string near = nearest_option("-" + wanted);
    throw UserError(fmt::format("-help {}: no option has that in its name or text{}", shown(words),
                                near.empty() ? "" : "; the nearest name is " + near));
  }
  if (!words.empty()) return list.substr(1);
  return fmt::format("pdxsolve {}: brittle fracture with elements and peridynamics\n"
                     "mpirun -n N pdxsolve -options_file case.opts [any PETSc option]\n"
                     "pdxsolve -help WORD ... shows the options with all these words, -help -json all as JSON\n"
                     "A unit may stand directly behind a number: 72GPa, 1mm, 20us; without one it is that of SI.\n{}",
                     PDX_VERSION, list) +
         "\nCrack faces and parts of a mesh do not touch: there is contact between bodies of a scene with -mpm_bodies "
         "only, "
         "all else passes through what it meets.\n"
         "\nSolver options are PETSc's: -snes_..., -ksp_..., -pc_..., -mg_levels_..., -mg_coarse_..., -log_view.\n" +
         manual();
}

std::string help_json()
{
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const OptionDoc& doc : all_options())
    all.push_back({{"name", doc.name},
                   {"room", doc.room},
                   {"unit", doc.unit},
                   {"default", doc.default_value},
                   {"allowed", doc.allowed},
                   {"help", doc.help}});
  return all.dump(1) + "\n";
}
} // namespace pdx::options
