#include "pdx/io/hdf5_file.hpp"

#include "pdx/base/error.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/hdf5_slab.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

namespace pdx::io {
namespace {
/// Why the operating system would not let rank 0 create the file, "" if it does.
std::string creation_obstacle(MPI_Comm comm, const std::filesystem::path& path)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank) return "";
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (!file) return std::strerror(errno);
  std::fclose(file);
  return "";
}

hid_t open(MPI_Comm comm, const std::filesystem::path& path, Hdf5File::Mode mode)
{
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
  H5Pset_all_coll_metadata_ops(access, true);
  H5Pset_coll_metadata_write(access, true);
  if (mode == Hdf5File::Mode::append) return H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
  const Hdf5Id creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access);
}

hid_t with_parents()
{
  const hid_t list = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(list, 1);
  return list;
}
} // namespace

Hdf5File::Hdf5File(MPI_Comm comm, std::filesystem::path path, Mode mode) : comm_(comm), path_(std::move(path))
{
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string reason = mode == Mode::create ? first_message(comm_, creation_obstacle(comm_, path_)) : "";
  if (reason.empty()) {
    file_ = open(comm_, path_, mode);
    reason = first_message(comm_, file_ >= 0 ? "" : hdf5_reason());
  }
  if (reason.empty()) return;
  if (file_ >= 0) H5Fclose(file_);
  throw UserError((mode == Mode::create ? "cannot create '" : "cannot open '") + path_.string() + "': " + reason);
}

Hdf5File::~Hdf5File()
{
  int over = 0;
  MPI_Finalized(&over);
  if (!over && file_ >= 0) H5Fclose(file_);
}

void Hdf5File::close()
{
  const bool closed = H5Fclose(std::exchange(file_, H5I_INVALID_HID)) >= 0;
  agree(closed, "the end");
}

void Hdf5File::agree(bool ok, const std::string& what) const
{
  const std::string reason = first_message(comm_, ok ? "" : hdf5_reason());
  if (!reason.empty()) throw SolverFailure("cannot write " + what + " to '" + path_.string() + "': " + reason);
}

void Hdf5File::group(const std::string& path)
{
  const Hdf5Id parents(with_parents(), H5Pclose);
  const Hdf5Id made(H5Gcreate2(file_, path.c_str(), parents, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  agree(made.valid(), path);
}

void Hdf5File::dataset(const std::string& path, std::span<const double> slab, int components)
{
  write_slab(path, slab.data(), slab.size() / components, components, {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE});
}

void Hdf5File::dataset(const std::string& path, std::span<const int> slab, int components)
{
  write_slab(path, slab.data(), slab.size() / components, components, {H5T_NATIVE_INT, H5T_STD_I32LE});
}

void Hdf5File::dataset(const std::string& path, std::span<const std::uint64_t> slab, int components)
{
  write_slab(path, slab.data(), slab.size() / components, components, {H5T_NATIVE_UINT64, H5T_STD_U64LE});
}

void Hdf5File::write_slab(const std::string& path, const void* slab, std::size_t rows, int components, Types types)
{
  unsigned long long mine = rows, before = 0, all = 0;
  MPI_Exscan(&mine, &before, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  MPI_Allreduce(&mine, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  const auto columns = static_cast<hsize_t>(components);
  const std::array<hsize_t, 2> total{all, columns};

  const Hdf5Id parents(with_parents(), H5Pclose);
  const Hdf5Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  H5Pset_obj_track_times(creation, false);
  const Hdf5Id whole(H5Screate_simple(2, total.data(), nullptr), H5Sclose);
  const Hdf5Id set(H5Dcreate2(file_, path.c_str(), types.file, whole, parents, creation, H5P_DEFAULT), H5Dclose);
  agree(set.valid(), path);
  if (all == 0) return;

  const Hdf5Slab here(set, before, rows, columns);
  const double nothing = 0.0;
  agree(H5Dwrite(set, types.memory, here.in_memory, here.in_file, here.transfer, rows ? slab : &nothing) >= 0, path);
}

void Hdf5File::attribute(const std::string& object, const std::string& name, double value)
{
  write_attribute(object, name, &value, {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE});
}

void Hdf5File::attribute(const std::string& object, const std::string& name, int value)
{
  write_attribute(object, name, &value, {H5T_NATIVE_INT, H5T_STD_I32LE});
}

void Hdf5File::attribute(const std::string& object, const std::string& name, std::string_view value)
{
  const std::string text(value);
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  write_attribute(object, name, text.c_str(), {type, type});
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, const void* value, Types types)
{
  const Hdf5Id scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id made(
      H5Acreate_by_name(file_, object.c_str(), name.c_str(), types.file, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  agree(made.valid() && H5Awrite(made, types.memory, value) >= 0, object + ":" + name);
}

void Hdf5File::flush() { agree(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0, "what is buffered"); }
} // namespace pdx::io
