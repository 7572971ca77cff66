#include "pdx/app/arguments.hpp"

#include <fmt/format.h>
#include <fstream>
#include <petscsys.h>
#include <sstream>
#include <string_view>

namespace pdx::app {
namespace {
constexpr int kDeepest = 16; // files named in files; PETSc itself would follow a circle for ever

/// The file named by a line "-options_file FILE", "" for any other line.
std::string nested_file(const std::string& line)
{
  std::istringstream words(line);
  std::string option, file;
  words >> option >> file;
  return option == "-options_file" ? file : "";
}

/// The first thing in an options file, or in the files it names, that PETSc would not take; "" if none.
std::string fault_of(const std::string& path, int depth = 0)
{
  std::ifstream file(path);
  if (!file.good() || file.peek() == std::ifstream::traits_type::eof())
    return fmt::format("-options_file {}: cannot be read; check the path", path);
  if (path.ends_with(".yaml") || path.ends_with(".yml")) return "";
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    if (const std::string nested = nested_file(line.substr(begin)); !nested.empty()) {
      if (depth == kDeepest)
        return fmt::format("-options_file {}, line {}: more than {} files named in files, or a circle", path, number,
                           kDeepest);
      const std::string fault = fault_of(nested, depth + 1);
      if (!fault.empty())
        return fault.ends_with(')') ? fault : fmt::format("{} (named in {}, line {})", fault, path, number);
    }
    if (line[begin] == '-') continue;
    return fmt::format("-options_file {}, line {}: \"{}\" is no option: lines are -name value, or # comment", path,
                       number, line.substr(begin, 40));
  }
  return "";
}
} // namespace

Arguments look_at_arguments(int& argc, char** argv)
{
  Arguments found;
  int kept = 1;
  for (int k = 1; k < argc; ++k) {
    const std::string_view argument = argv[k];
    if (argument == "-help" || argument == "--help" || argument == "-h")
      found.help = true;
    else if (argument == "-version" || argument == "--version" || argument == "-v")
      found.version = true;
    else if (argument == "-options_file") {
      const std::string fault = k + 1 < argc ? fault_of(argv[k + 1]) : "-options_file has no value: give a path";
      if (fault.empty()) {
        argv[kept++] = argv[k];
        argv[kept++] = argv[k + 1];
      } else if (found.error.empty())
        found.error = fault;
      ++k;
    } else
      argv[kept++] = argv[k];
  }
  argc = kept;
  argv[argc] = nullptr;
  return found;
}

void print_version()
{
  char petsc[256] = "";
  (void)PetscGetVersion(petsc, sizeof petsc);
  fmt::print("pdxsolve {} with {}\n", PDX_VERSION, petsc);
}
} // namespace pdx::app
