#include "pdx/record/run_record.hpp"

#include "pdx/base/given_options.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/earlier_files.hpp"
#include "pdx/io/provenance.hpp"

#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <utility>

namespace pdx::record {
namespace {
constexpr Source kProgram{
    "pdxsolve", "the program", "pdxsolve, version and commit as in options.opts",
    "@software{pdxsolve,\n  title = {pdxsolve: brittle fracture with elements, peridynamics and material points}\n}\n"};
constexpr Source kPetsc{"petsc", "solvers and steps in time",
                        "Balay et al., PETSc/TAO Users Manual, ANL-21/39, Argonne National Laboratory",
                        "@techreport{petsc,\n  author = {Satish Balay and others},\n  title = {{PETSc/TAO} Users "
                        "Manual},\n  institution = {Argonne National Laboratory},\n  number = {ANL-21/39}\n}\n"};
constexpr Source kPartOne{
    "giannakeas2020part1", "elements, cracks in them and particles side by side",
    "Giannakeas, Papathanasiou, Fallah, Bahai 2020, Computational Mechanics, doi:10.1007/s00466-020-01843-z",
    "@article{giannakeas2020part1,\n  author = {Ilias N. Giannakeas and Theodosios K. Papathanasiou and Arash S. "
    "Fallah "
    "and Hamid Bahai},\n  title = {Coupling {XFEM} and peridynamics for brittle fracture simulation---part {I}: "
    "feasibility and effectiveness},\n  journal = {Computational Mechanics},\n  year = {2020},\n  doi = "
    "{10.1007/s00466-020-01843-z}\n}\n"};
constexpr Source kPartTwo{
    "giannakeas2020part2", "patches that move",
    "Giannakeas, Papathanasiou, Fallah, Bahai 2020, Computational Mechanics, doi:10.1007/s00466-020-01872-8",
    "@article{giannakeas2020part2,\n  author = {Ilias N. Giannakeas and Theodosios K. Papathanasiou and Arash S. "
    "Fallah "
    "and Hamid Bahai},\n  title = {Coupling {XFEM} and peridynamics for brittle fracture simulation: part "
    "{II}---adaptive "
    "relocation strategy},\n  journal = {Computational Mechanics},\n  year = {2020},\n  doi = "
    "{10.1007/s00466-020-01872-8}\n}\n"};
constexpr Source kPoints{
    "zeng2022", "material points",
    "Zeng, Zhang, Zhang, Liu, Chen 2022, Computer Methods in Applied Mechanics and Engineering",
    "@article{zeng2022,\n  author = {Zhixin Zeng and Heng Zhang and Xiong Zhang and Yan Liu and Zhen Chen},\n  title = "
    "{An adaptive peridynamics material point method for dynamic fracture problem},\n  journal = {Computer Methods in "
    "Applied Mechanics and Engineering},\n  year = {2022}\n}\n"};

/// A value as it stands in a file.
std::string quoted(const std::string& value)
{
  if (value.find_first_of(" \t#'\"") == std::string::npos) return value;
  const char mark = value.find('"') == std::string::npos ? '"' : '\'';
  return fmt::format("{0}{1}{0}", mark, value);
}

std::string given_line(const GivenOption& option)
{
  const std::string line = option.value.empty() ? option.name : option.name + " " + quoted(option.value);
  return fmt::format("{:<44} # {}\n", line, option.place.empty() ? "command line" : option.place);
}

bool stands_for_others(const std::string& name) { return name.find("NAME") != std::string::npos; }

std::string head(MPI_Comm comm, const options::SceneOptions& options)
{
  std::string made;
  for (const auto& [name, value] : io::provenance(comm))
    made += fmt::format("{}{} {}", made.empty() ? "" : ", ", name, value);
  const std::time_t now = std::time(nullptr);
  return fmt::format(
      "# pdxsolve options as used: case {}, {:%Y-%m-%d %H:%M:%S} UTC\n# {}\n"
      "# Given: a line each. Left at its default: behind a #. Paths count from where the run was begun.\n",
      options.case_name, fmt::gmtime(now), made);
}

/// A file that another run wrote, or none.
bool may_replace(const std::filesystem::path& path)
{
  std::error_code none;
  return !std::filesystem::exists(path, none) || io::is_of_a_run(path);
}

void write(MPI_Comm comm, const std::filesystem::path& path, const std::string& text)
{
  int may = may_replace(path);
  MPI_Bcast(&may, 1, MPI_INT, 0, comm);
  if (may) io::replace_file(comm, path, text);
}
} // namespace

std::vector<Source> sources_of(const options::SceneOptions& options)
{
  std::vector<Source> all;
  if (options.pd.bordered() || !options.cracks.lines.empty()) all.push_back(kPartOne);
  if (options.layout.patches_move()) all.push_back(kPartTwo);
  if (options.points.any()) all.push_back(kPoints);
  all.push_back(kPetsc);
  all.push_back(kProgram);
  return all;
}

std::string options_as_used(MPI_Comm comm, const options::SceneOptions& options)
{
  std::string text = head(comm, options), room;
  for (const OptionDoc& doc : documented_options()) {
    if (stands_for_others(doc.name) || doc.name == "-options_file") continue;
    if (doc.room != room) text += fmt::format("\n# --- {}\n", room = doc.room);
    const GivenOption* option = given_option(doc.name);
    if (option && doc.name != "-dry_run")
      text += given_line(*option);
    else
      text += fmt::format("# {} {}\n", doc.name, doc.default_value);
  }
  room.clear();
  for (const auto& [name, option] : given_options()) {
    if (!is_petsc_name(name) || is_documented(name)) continue;
    if (room.empty()) text += fmt::format("\n# --- {}\n", room = "PETSc");
    text += given_line(option);
  }
  return text;
}

void write_record(MPI_Comm comm, const options::SceneOptions& options)
{
  const std::filesystem::path directory = options.output.directory;
  write(comm, directory / "options.opts", options_as_used(comm, options));
  std::string bibliography = "% pdxsolve: what this run should cite\n";
  for (const Source& source : sources_of(options))
    bibliography += fmt::format("\n% {}\n{}", source.what, source.bibtex);
  write(comm, directory / "citations.bib", bibliography);
}

std::string citation_line(const options::SceneOptions& options)
{
  std::string line = "please cite (citations.bib): ";
  bool first = true;
  for (const Source& source : sources_of(options)) {
    if (!std::exchange(first, false)) line += "; ";
    line += source.name;
  }
  return line;
}
} // namespace pdx::record
