#include "pdx/io/hdf5_reader.hpp"

#include "pdx/base/error.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/hdf5_slab.hpp"

#include <vector>

namespace pdx::io {
namespace {
/// Why rank 0 sees no such file, "" if it does.
std::string obstacle(MPI_Comm comm, const std::filesystem::path& path)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  std::error_code error;
  return rank || std::filesystem::is_regular_file(path, error) ? "" : "there is no such file";
}
} // namespace

Hdf5Reader::Hdf5Reader(MPI_Comm comm, std::filesystem::path path) : comm_(comm), path_(std::move(path))
{
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string reason = first_message(comm_, obstacle(comm_, path_));
  if (reason.empty()) {
    const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_mpio(access, comm_, MPI_INFO_NULL);
    H5Pset_all_coll_metadata_ops(access, true);
    file_ = H5Fopen(path_.c_str(), H5F_ACC_RDONLY, access);
    reason = first_message(comm_, file_ >= 0 ? "" : hdf5_reason());
  }
  if (reason.empty()) return;
  if (file_ >= 0) H5Fclose(file_);
  throw UserError("cannot read '" + path_.string() + "': " + reason);
}

Hdf5Reader::~Hdf5Reader()
{
  int over = 0;
  MPI_Finalized(&over);
  if (!over) H5Fclose(file_);
}

void Hdf5Reader::require(bool ok, const std::string& what) const
{
  const std::string reason = first_message(comm_, ok ? "" : what);
  if (!reason.empty()) throw UserError("cannot read '" + path_.string() + "': " + reason);
}

bool Hdf5Reader::has(const std::string& path) const { return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0; }

std::array<std::int64_t, 2> Hdf5Reader::shape(const std::string& path) const
{
  const Hdf5Id set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  require(set.valid(), "it has no dataset " + path);
  const Hdf5Id space(H5Dget_space(set), H5Sclose);
  require(H5Sget_simple_extent_ndims(space) == 2, path + " is not a table");
  std::array<hsize_t, 2> extent{};
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  return {static_cast<std::int64_t>(extent[0]), static_cast<std::int64_t>(extent[1])};
}

void Hdf5Reader::read(const std::string& path, std::int64_t first, int components, std::span<double> slab) const
{
  read_slab(path, {first, 0, static_cast<std::int64_t>(slab.size()) / components, components}, slab.data(),
            H5T_NATIVE_DOUBLE);
}

void Hdf5Reader::read(const std::string& path, std::int64_t first, int components, std::span<std::uint64_t> slab) const
{
  read_slab(path, {first, 0, static_cast<std::int64_t>(slab.size()) / components, components}, slab.data(),
            H5T_NATIVE_UINT64);
}

/// @param slab first row and column, rows and columns
void Hdf5Reader::read_slab(const std::string& path, std::array<std::int64_t, 4> slab, void* values, hid_t type) const
{
  const auto [rows, columns] = shape(path);
  require(columns == slab[3] && slab[0] >= 0 && slab[0] + slab[2] <= rows, path + " has " + std::to_string(rows) +
                                                                               " x " + std::to_string(columns) +
                                                                               " numbers, too few or of another kind");
  if (rows == 0) return;
  const Hdf5Id set(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Slab here(set, static_cast<hsize_t>(slab[0]), static_cast<hsize_t>(slab[2]), static_cast<hsize_t>(slab[3]));
  double nothing = 0.0;
  const bool ok = H5Dread(set, type, here.in_memory, here.in_file, here.transfer, slab[2] ? values : &nothing) >= 0;
  require(ok, ok ? "" : path + ": " + hdf5_reason());
}

void Hdf5Reader::read_attribute(const std::string& object, const std::string& name, void* value, hid_t type) const
{
  const Hdf5Id found(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(found.valid() && H5Aread(found, type, value) >= 0, "it has no attribute " + name + " of " + object);
}

double Hdf5Reader::real(const std::string& object, const std::string& name) const
{
  double value = 0.0;
  read_attribute(object, name, &value, H5T_NATIVE_DOUBLE);
  return value;
}

int Hdf5Reader::integer(const std::string& object, const std::string& name) const
{
  int value = 0;
  read_attribute(object, name, &value, H5T_NATIVE_INT);
  return value;
}

std::string Hdf5Reader::text(const std::string& object, const std::string& name) const
{
  const Hdf5Id found(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(found.valid(), "it has no attribute " + name + " of " + object);
  const Hdf5Id type(H5Aget_type(found), H5Tclose);
  require(H5Tget_class(type) == H5T_STRING && !H5Tis_variable_str(type), "attribute " + name + " is not a text");
  std::vector<char> value(H5Tget_size(type) + 1, '\0');
  require(H5Aread(found, type, value.data()) >= 0, "attribute " + name + " cannot be read");
  return value.data();
}
} // namespace pdx::io
