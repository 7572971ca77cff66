#include "pdx/options/arguments.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/petsc.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/options/option_reader.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>

namespace pdx::options {
namespace {
constexpr int kMostOfPetsc = 400; // PETSc 3.18 has room for 512, some of which are set by us

std::string environment(const char* name)
{
  const char* text = std::getenv(name);
  return text ? text : "";
}

bool skips_resource_files(std::span<const std::string> words)
{
  const auto at = std::ranges::find(words, "-skip_petscrc");
  if (at == words.end()) return false;
  return at + 1 == words.end() || (at[1] != "false" && at[1] != "0" && at[1] != "no" && at[1] != "off");
}

/// All that the first rank reads, as fields that end with a NUL, which none of them holds: help, JSON, words, version,
/// error, then name, value and place of each option.
std::string read_all(int argc, char** argv)
{
  OptionReader reader;
  std::string error, fields;
  std::vector<GivenOption> options;
  try {
    const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (!skips_resource_files(words)) reader.read_resource_files(environment("HOME"));
    if (!environment("PETSC_OPTIONS_YAML").empty())
      throw UserError("PETSC_OPTIONS_YAML: YAML is not read: use PETSC_OPTIONS, or -options_file");
    reader.read_environment("PETSC_OPTIONS", environment("PETSC_OPTIONS"));
    reader.read_command_line(words);
    options = reader.take();
  } catch (const UserError& wrong) {
    error = wrong.what();
  }
  const auto add = [&](const std::string& field) { fields.append(field).push_back('\0'); };
  add(reader.help ? "help" : "");
  add(reader.json ? "json" : "");
  add(reader.help_words);
  add(reader.version ? "version" : "");
  add(error);
  for (const GivenOption& option : options) add(option.name), add(option.value), add(option.place);
  return fields;
}
} // namespace

Arguments read_arguments(MPI_Comm comm, int argc, char** argv)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::string fields;
  if (rank == 0) fields = read_all(argc, argv);
  auto size = static_cast<int>(fields.size());
  MPI_Bcast(&size, 1, MPI_INT, 0, comm);
  fields.resize(static_cast<std::size_t>(size));
  MPI_Bcast(fields.data(), size, MPI_CHAR, 0, comm);
  for (const char* name : {"PETSC_OPTIONS", "PETSC_OPTIONS_YAML"}) unsetenv(name); // PETSc would read them again
  std::size_t at = 0;
  const auto next = [&] {
    std::string field = fields.c_str() + at;
    at += field.size() + 1;
    return field;
  };
  Arguments arguments;
  arguments.help = !next().empty();
  arguments.json = !next().empty();
  arguments.help_words = next();
  arguments.version = !next().empty();
  arguments.error = next();
  while (at < fields.size()) {
    GivenOption option{next(), "", ""};
    option.value = next();
    option.place = next();
    give_option(std::move(option));
  }
  return arguments;
}

void hand_options_to_petsc()
{
  int count = 0;
  for (const auto& [name, option] : given_options()) {
    if (!is_petsc_name(name)) continue;
    if (++count > kMostOfPetsc)
      throw UserError(fmt::format("more than {} options of PETSc are given: it has no room for more", kMostOfPetsc));
    PDX_CALL(PetscOptionsSetValue(nullptr, name.c_str(), option.value.empty() ? nullptr : option.value.c_str()));
  }
}

std::string version_text()
{
  char petsc[256] = "";
  (void)PetscGetVersion(petsc, sizeof petsc);
  return fmt::format("pdxsolve {} with {}\n", PDX_VERSION, petsc);
}
} // namespace pdx::options
