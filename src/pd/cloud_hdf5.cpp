#include "pdx/pd/cloud_hdf5.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/hdf5_id.hpp"
#include "pdx/base/trial.hpp"

#include <fmt/format.h>
#include <limits>
#include <string>
#include <utility>

namespace pdx::pd {
namespace {
constexpr hsize_t kMostPacked = 1100; // numbers may be packed; deflate's best is 1032
constexpr double kSlowest = 5e6;      // reading of a file, above 20 s in all [B/s]

/// Why the values of a dataset cannot be in a file of `bytes`, "" if they can.
std::string fault_of(hid_t set, hsize_t numbers, std::uintmax_t bytes)
{
  const Hdf5Id list(H5Dget_create_plist(set), H5Pclose), type(H5Dget_type(set), H5Tclose);
  const H5D_layout_t layout = H5Pget_layout(list);
  if (layout == H5D_VIRTUAL || H5Pget_external_count(list) > 0)
    return "keeps its values in other files: copy them into it";
  const H5T_class_t kind = H5Tget_class(type);
  if (kind != H5T_FLOAT && kind != H5T_INTEGER) return "must hold numbers";
  const hsize_t size = H5Tget_size(type), stored = H5Dget_storage_size(set);
  const bool packed = layout == H5D_CHUNKED && H5Pget_nfilters(list) > 0;
  if (size == 0 || size > 16) return "must hold numbers of at most 16 bytes";
  if (numbers > bytes * (packed ? kMostPacked : 1) / size || (numbers > 0 && (stored == 0 || stored > bytes)))
    return fmt::format("says it has {} numbers, more than a file of {} bytes can hold", numbers, bytes);
  return "";
}

struct File {
  hid_t id;
  std::string path;
  std::uintmax_t bytes;
};

/// Reads a dataset with `width` numbers per particle; [particles] is as good as [particles x 1].
template <class Number> std::vector<Number> read_dataset(const File& file, const char* name, hsize_t width, hid_t type)
{
  const auto refuse = [&](const std::string& why) {
    return UserError(fmt::format("particles: dataset '{}' of '{}' {}", name, file.path, why));
  };
  H5L_info_t link{};
  if (H5Lget_info(file.id, name, &link, H5P_DEFAULT) >= 0 && link.type == H5L_TYPE_EXTERNAL)
    throw refuse("is in another file: copy it into this one");
  const Hdf5Id set(H5Dopen2(file.id, name, H5P_DEFAULT), H5Dclose);
  if (!set.valid()) throw refuse("is missing, or damaged");
  const Hdf5Id space(H5Dget_space(set), H5Sclose);
  hsize_t extent[2] = {0, 1};
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank == 1 || rank == 2) H5Sget_simple_extent_dims(space, extent, nullptr);
  if ((rank != 1 && rank != 2) || extent[1] != width)
    throw refuse(fmt::format("must have the shape [particles x {}]", width));
  if (extent[0] > static_cast<hsize_t>(std::numeric_limits<Index>::max()))
    throw refuse(fmt::format("has {} particles: must be at most {}", extent[0], std::numeric_limits<Index>::max()));
  if (const std::string why = fault_of(set, extent[0] * width, file.bytes); !why.empty()) throw refuse(why);
  std::vector<Number> values(extent[0] * width);
  if (H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw refuse("cannot be read: it is damaged");
  return values;
}

/// HDF5 would cut down, without a word, what is no whole number or does not fit.
std::vector<Index> read_sets(const File& file)
{
  const std::string where = fmt::format("particles: dataset 'set' of '{}' ", file.path);
  const Hdf5Id set(H5Dopen2(file.id, "set", H5P_DEFAULT), H5Dclose);
  const Hdf5Id type(set.valid() ? H5Dget_type(set) : H5I_INVALID_HID, H5Tclose);
  if (!type.valid() || H5Tget_class(type) != H5T_INTEGER) throw UserError(where + "must hold whole numbers");
  std::vector<Index> sets;
  for (const std::int64_t number : read_dataset<std::int64_t>(file, "set", 1, H5T_NATIVE_INT64)) {
    if (!std::in_range<Index>(number))
      throw UserError(fmt::format("{}holds {}: it must be within -2147483648 and 2147483647", where, number));
    sets.push_back(static_cast<Index>(number));
  }
  return sets;
}

template <int Dim> Cloud<Dim> read_file(const std::filesystem::path& path)
{
  std::error_code none;
  const Hdf5Id id(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const File file{id, path.string(), std::filesystem::file_size(path, none)};
  if (!id.valid()) throw UserError(fmt::format("particles: cannot read the file '{}' as HDF5", file.path));
  const auto positions = read_dataset<double>(file, "position", Dim, H5T_NATIVE_DOUBLE);
  Cloud<Dim> cloud;
  for (std::size_t k = 0; k * Dim < positions.size(); ++k)
    cloud.points.push_back(Eigen::Map<const Vector<Dim>>(&positions[k * Dim]));
  cloud.volumes = read_dataset<double>(file, "volume", 1, H5T_NATIVE_DOUBLE);
  cloud.sets.assign(cloud.points.size(), 0);
  if (H5Lexists(id, "set", H5P_DEFAULT) > 0) cloud.sets = read_sets(file);
  if (cloud.volumes.size() != cloud.points.size() || cloud.sets.size() != cloud.points.size())
    throw UserError(
        fmt::format("particles: '{}' has {} positions, {} volumes and {} sets; there must be as many of each",
                    file.path, cloud.points.size(), cloud.volumes.size(), cloud.sets.size()));
  return cloud;
}

/// HDF5's own printing of errors is off meanwhile.
class Quiet {
public:
  Quiet()
  {
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};
} // namespace

template <int Dim> Cloud<Dim> read_cloud_hdf5(const std::filesystem::path& path)
{
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none))
    throw UserError(fmt::format("particles: cannot read the file '{}'", path.string()));
  const Quiet quiet;
  const auto seconds =
      static_cast<unsigned>(20.0 + static_cast<double>(std::filesystem::file_size(path, none)) / kSlowest);
  if (const std::string why = try_apart([&] { (void)read_file<Dim>(path); }, seconds); !why.empty())
    throw UserError(fmt::format("particles: the file '{}' is damaged: {}", path.string(), why));
  return read_file<Dim>(path);
}

template Cloud<2> read_cloud_hdf5<2>(const std::filesystem::path&);
template Cloud<3> read_cloud_hdf5<3>(const std::filesystem::path&);
} // namespace pdx::pd
