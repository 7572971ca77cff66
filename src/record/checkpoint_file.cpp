#include "pdx/record/checkpoint_file.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/events.hpp"
#include "pdx/io/agree.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <sstream>

namespace pdx::record {
namespace {
constexpr const char* kNumbers = "/numbers";
constexpr const char* kNumberNames = "/number_names";

std::vector<std::string> split(const std::string& text)
{
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// "crack 1" of "crack 1 = (0, 0.5) (1, 0.5)".
std::string name_of(const std::string& line) { return line.substr(0, line.find(" =")); }

/// The first line of that name, or of any, that the others have not; "" if they have all.
std::string line_apart(const std::vector<std::string>& lines, const std::vector<std::string>& others,
                       const std::string& name = "")
{
  const auto apart = std::ranges::find_if(lines, [&](const std::string& line) {
    return (name.empty() || name_of(line) == name) && std::ranges::find(others, line) == others.end();
  });
  return apart == lines.end() ? "" : *apart;
}

bool is_first_rank(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank == 0;
}
} // namespace

void write_numbers(io::Hdf5File& file, const NamedNumbers& numbers)
{
  std::string names;
  std::vector<double> values;
  for (const auto& [name, value] : numbers) {
    names += name + "\n";
    if (is_first_rank(file.comm())) values.push_back(value);
  }
  file.dataset(kNumbers, std::span<const double>(values), 1);
  file.text(kNumberNames, names);
}

NamedNumbers read_numbers(const io::SealedReader& file)
{
  const std::vector<std::string> names = split(file.text(kNumberNames));
  const std::vector<double> values = file.column(kNumbers);
  file.require(kNumbers, names.size() == values.size() ? "" : "has other names than numbers");
  NamedNumbers numbers;
  for (std::size_t k = 0; k < names.size(); ++k) numbers[names[k]] = values[k];
  return numbers;
}

void refuse_another(const io::SealedReader& file, const std::string& path, const char* text, const std::string& mine)
{
  const std::vector<std::string> there = split(file.text(text)), here = split(mine);
  const std::string one = line_apart(here, there), other = line_apart(there, here, name_of(one));
  if (one.empty() && other.empty()) return;
  const auto shown = [](const std::string& line) { return line.empty() ? "no more" : "\"" + line + "\""; };
  throw UserError(fmt::format("-restart is {}: it is of another scene, which has {}; this one has {}", path,
                              shown(other), shown(one)));
}

std::filesystem::path checkpoint_in(const std::string& directory)
{
  return std::filesystem::path(directory) / "checkpoint.h5";
}

bool is_of(MPI_Comm comm, const std::string& checkpoint, const std::string& directory)
{
  std::error_code none;
  const std::filesystem::path parent = std::filesystem::path(checkpoint).parent_path();
  int here = std::filesystem::equivalent(parent.empty() ? "." : parent, directory, none);
  MPI_Bcast(&here, 1, MPI_INT, 0, comm);
  return here != 0;
}

void write_checkpoint(MPI_Comm comm, const std::filesystem::path& path, const std::function<void(io::Hdf5File&)>& fill)
{
  static Event event("io_checkpoint");
  const Timed timed(event);
  const std::filesystem::path part = path.string() + ".part";
  try {
    io::Hdf5File file(comm, part, io::Hdf5File::Mode::sealed);
    fill(file);
    file.close();
    io::rename_durably(comm, part, path);
  } catch (...) { // no half of one stays, and what was there is untouched
    std::error_code none;
    if (is_first_rank(comm)) std::filesystem::remove(part, none);
    throw;
  }
}
} // namespace pdx::record
