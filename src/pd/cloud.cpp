#include "pdx/pd/cloud.hpp"

#include "pdx/base/error.hpp"
#include "pdx/pd/cloud_hdf5.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <string>
#include <string_view>

namespace pdx::pd {
namespace {
std::vector<std::string_view> columns_of(std::string_view line)
{
  std::vector<std::string_view> columns;
  while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    std::string_view column = line.substr(from, comma - from);
    while (!column.empty() && column.front() == ' ') column.remove_prefix(1);
    while (!column.empty() && column.back() == ' ') column.remove_suffix(1);
    columns.push_back(column);
    from = comma + 1;
  }
  return columns;
}

template <class Number> bool read_number(std::string_view text, Number& value)
{
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// Of a line, for a message.
std::string beginning(const std::string& line)
{
  constexpr std::size_t most = 60;
  return line.size() <= most ? line : line.substr(0, most) + "...";
}

template <int Dim> Cloud<Dim> read_csv(const std::filesystem::path& path)
{
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line))
    throw UserError(fmt::format("particles: cannot read the file '{}'", path.string()));
  std::vector<std::string_view> wanted{"x", "y"};
  if (Dim == 3) wanted.push_back("z");
  wanted.push_back("volume");
  const std::vector<std::string_view> names = columns_of(line);
  const bool with_sets = names.size() == wanted.size() + 1 && names.back() == "set";
  if (with_sets) wanted.push_back("set");
  if (names != wanted)
    throw UserError(fmt::format("particles: the first line of '{}' is '{}'; it must name the columns {}[,set]",
                                path.string(), beginning(line), Dim == 3 ? "x,y,z,volume" : "x,y,volume"));
  Cloud<Dim> cloud;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string_view> values = columns_of(line);
    if (values.size() == 1 && values[0].empty()) continue;
    Vector<Dim> x;
    double volume = 0.0;
    Index set = 0;
    bool good = values.size() == wanted.size();
    for (std::size_t d = 0; good && d < Dim; ++d) good = read_number(values[d], x[static_cast<Eigen::Index>(d)]);
    good = good && read_number(values[Dim], volume) && (!with_sets || read_number(values[Dim + 1], set));
    if (!good)
      throw UserError(fmt::format("particles: line {} of '{}' is '{}'; {} numbers ({}) are needed", number,
                                  path.string(), beginning(line), wanted.size(), fmt::join(wanted, ",")));
    cloud.points.push_back(x);
    cloud.volumes.push_back(volume);
    cloud.sets.push_back(set);
  }
  return cloud;
}

} // namespace

template <int Dim> Cloud<Dim> read_cloud(const std::filesystem::path& path)
{
  const std::string kind = path.extension().string();
  if (kind != ".csv" && kind != ".h5" && kind != ".hdf5")
    throw UserError(fmt::format("particles: '{}' must be a *.csv, *.h5 or *.hdf5 file", path.string()));
  Cloud<Dim> cloud = kind == ".csv" ? read_csv<Dim>(path) : read_cloud_hdf5<Dim>(path);
  if (cloud.points.empty()) throw UserError(fmt::format("particles: '{}' has none", path.string()));
  for (std::size_t k = 0; k < cloud.points.size(); ++k) {
    if (!cloud.points[k].allFinite())
      throw UserError(fmt::format("particles: particle {} of '{}' has no finite position", k + 1, path.string()));
    if (!(cloud.volumes[k] > 0.0) || !std::isfinite(cloud.volumes[k]))
      throw UserError(fmt::format("particles: particle {} of '{}' has the volume {:g}; it must be above 0 and finite",
                                  k + 1, path.string(), cloud.volumes[k]));
  }
  return cloud;
}

template Cloud<2> read_cloud<2>(const std::filesystem::path&);
template Cloud<3> read_cloud<3>(const std::filesystem::path&);
} // namespace pdx::pd
