#include "pdx/pd/cloud.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/hdf5_id.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

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

/// Reads a dataset with `width` numbers per particle; [particles] is as good as [particles x 1].
template <class Number>
std::vector<Number> read_dataset(hid_t file, const char* name, hsize_t width, hid_t type, const std::string& path)
{
  const auto refuse = [&](const std::string& why) {
    return UserError(fmt::format("particles: dataset '{}' of '{}' {}", name, path, why));
  };
  const Hdf5Id set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
  if (!set.valid()) throw refuse("is missing");
  const Hdf5Id space(H5Dget_space(set), H5Sclose);
  hsize_t extent[2] = {0, 1};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank == 1 || rank == 2) H5Sget_simple_extent_dims(space, extent, nullptr);
  if ((rank != 1 && rank != 2) || extent[1] != width)
    throw refuse(fmt::format("must have the shape [particles x {}]", width));
  std::vector<Number> values(extent[0] * width);
  if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) throw refuse("cannot be read");
  return values;
}

/// HDF5 would cut down, without a word, what is no whole number or does not fit.
std::vector<Index> read_sets(hid_t file, const std::string& path)
{
  const std::string where = fmt::format("particles: dataset 'set' of '{}' ", path);
  const Hdf5Id set(H5Dopen2(file, "set", H5P_DEFAULT), H5Dclose);
  const Hdf5Id type(H5Dget_type(set), H5Tclose);
  if (!set.valid() || H5Tget_class(type) != H5T_INTEGER) throw UserError(where + "must hold whole numbers");
  std::vector<Index> sets;
  for (const std::int64_t number : read_dataset<std::int64_t>(file, "set", 1, H5T_NATIVE_INT64, path)) {
    if (!std::in_range<Index>(number))
      throw UserError(fmt::format("{}holds {}: it must be within -2147483648 and 2147483647", where, number));
    sets.push_back(static_cast<Index>(number));
  }
  return sets;
}

template <int Dim> Cloud<Dim> read_open_hdf5(hid_t id, const std::string& path)
{
  const Hdf5Id file(id, H5Fclose);
  if (id < 0) throw UserError(fmt::format("particles: cannot read the file '{}' as HDF5", path));
  const auto positions = read_dataset<double>(id, "position", Dim, H5T_NATIVE_DOUBLE, path);
  Cloud<Dim> cloud;
  for (std::size_t k = 0; k * Dim < positions.size(); ++k)
    cloud.points.push_back(Eigen::Map<const Vector<Dim>>(&positions[k * Dim]));
  cloud.volumes = read_dataset<double>(id, "volume", 1, H5T_NATIVE_DOUBLE, path);
  cloud.sets.assign(cloud.points.size(), 0);
  if (H5Lexists(id, "set", H5P_DEFAULT) > 0) cloud.sets = read_sets(id, path);
  if (cloud.volumes.size() != cloud.points.size() || cloud.sets.size() != cloud.points.size())
    throw UserError(
        fmt::format("particles: '{}' has {} positions, {} volumes and {} sets; there must be as many of each", path,
                    cloud.points.size(), cloud.volumes.size(), cloud.sets.size()));
  return cloud;
}

/// HDF5's own printing of errors is off meanwhile.
template <int Dim> Cloud<Dim> read_hdf5(const std::filesystem::path& path)
{
  H5E_auto2_t print = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  struct Restore {
    H5E_auto2_t print;
    void* data;
    ~Restore() { H5Eset_auto2(H5E_DEFAULT, print, data); }
  } const restore{print, data};
  return read_open_hdf5<Dim>(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), path.string());
}
} // namespace

template <int Dim> Cloud<Dim> read_cloud(const std::filesystem::path& path)
{
  const std::string kind = path.extension().string();
  if (kind != ".csv" && kind != ".h5" && kind != ".hdf5")
    throw UserError(fmt::format("particles: '{}' must be a *.csv, *.h5 or *.hdf5 file", path.string()));
  Cloud<Dim> cloud = kind == ".csv" ? read_csv<Dim>(path) : read_hdf5<Dim>(path);
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
