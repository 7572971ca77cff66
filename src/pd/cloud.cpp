#include "pdx/pd/cloud.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/base/text_file.hpp"
#include "pdx/pd/cloud_hdf5.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <string_view>

namespace pdx::pd {
namespace {
template <int Dim> Cloud<Dim> read_csv(const std::filesystem::path& path)
{
  TextFile file("particles:", path);
  std::vector<std::string_view> wanted{"x", "y"};
  if (Dim == 3) wanted.push_back("z");
  wanted.push_back("volume");
  const std::string columns = fmt::format("{}", fmt::join(wanted, ","));
  if (!file.next()) throw UserError(fmt::format("particles: {}: has no line", shown_path(path.string())));
  const std::vector<std::string_view> names = cells_of(file.line());
  const bool with_sets = names.size() == wanted.size() + 1 && names.back() == "set";
  if (with_sets) wanted.push_back("set");
  if (names != wanted)
    file.refuse(fmt::format("is \"{}\": it must name the columns {}[,set]", shown(file.line()), columns));
  Cloud<Dim> cloud;
  while (file.next()) {
    const std::vector<std::string_view> values = cells_of(file.line());
    if (values.size() == 1 && values[0].empty()) continue;
    if (values.size() != wanted.size())
      file.refuse(fmt::format("is \"{}\": {} numbers ({}) are needed", shown(file.line()), wanted.size(),
                              fmt::join(wanted, ",")));
    Vector<Dim> x;
    for (std::size_t d = 0; d < Dim; ++d) x[static_cast<Eigen::Index>(d)] = file.real(values[d]);
    cloud.points.push_back(x);
    cloud.volumes.push_back(file.real(values[Dim]));
    cloud.sets.push_back(with_sets ? file.whole(values[Dim + 1]) : 0);
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
