#include "pdx/io/hdf5_file.hpp"

#include "pdx/base/error.hpp"
#include "pdx/io/agree.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

namespace pdx::io {
namespace {
/// Closes an HDF5 identifier at the end of its block.
class Id {
public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id()
  {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }
  bool valid() const { return id_ >= 0; }

private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

herr_t keep_deepest(unsigned, const H5E_error2_t* error, void* text)
{
  std::string& reason = *static_cast<std::string*>(text);
  if (reason.empty() && error->desc) reason = error->desc;
  return 0;
}

/// What HDF5 says about its last failed call.
std::string hdf5_reason()
{
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_deepest, &reason);
  return reason.empty() ? "HDF5 gives no reason" : reason;
}

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

hid_t create(MPI_Comm comm, const std::filesystem::path& path)
{
  const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_mpio(access, comm, MPI_INFO_NULL);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
  H5Pset_all_coll_metadata_ops(access, true);
  H5Pset_coll_metadata_write(access, true);
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
}

hid_t with_parents()
{
  const hid_t list = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(list, 1);
  return list;
}
} // namespace

Hdf5File::Hdf5File(MPI_Comm comm, std::filesystem::path path) : comm_(comm), path_(std::move(path))
{
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  std::string reason = first_message(comm_, creation_obstacle(comm_, path_));
  if (reason.empty()) {
    file_ = create(comm_, path_);
    reason = first_message(comm_, file_ >= 0 ? "" : hdf5_reason());
  }
  if (reason.empty()) return;
  if (file_ >= 0) H5Fclose(file_);
  throw UserError("cannot create '" + path_.string() + "': " + reason);
}

Hdf5File::~Hdf5File()
{
  int over = 0;
  MPI_Finalized(&over);
  if (!over) H5Fclose(file_);
}

void Hdf5File::agree(bool ok, const std::string& what) const
{
  const std::string reason = first_message(comm_, ok ? "" : hdf5_reason());
  if (!reason.empty()) throw SolverFailure("cannot write " + what + " to '" + path_.string() + "': " + reason);
}

void Hdf5File::group(const std::string& path)
{
  const Id parents(with_parents(), H5Pclose);
  const Id made(H5Gcreate2(file_, path.c_str(), parents, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
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

void Hdf5File::write_slab(const std::string& path, const void* slab, std::size_t rows, int components, Types types)
{
  unsigned long long mine = rows, before = 0, all = 0;
  MPI_Exscan(&mine, &before, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  MPI_Allreduce(&mine, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  const auto columns = static_cast<hsize_t>(components);
  const std::array<hsize_t, 2> total{all, columns}, count{rows, columns}, start{before, 0};

  const Id parents(with_parents(), H5Pclose);
  const Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  const Id in_file(H5Screate_simple(2, total.data(), nullptr), H5Sclose);
  const Id set(H5Dcreate2(file_, path.c_str(), types.file, in_file, parents, creation, H5P_DEFAULT), H5Dclose);
  agree(set.valid(), path);
  if (all == 0) return;

  const Id in_memory(H5Screate_simple(2, count.data(), nullptr), H5Sclose);
  if (rows)
    H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  else {
    H5Sselect_none(in_file);
    H5Sselect_none(in_memory);
  }
  const Id transfer(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  H5Pset_dxpl_mpio(transfer, H5FD_MPIO_COLLECTIVE);
  const double nothing = 0.0;
  agree(H5Dwrite(set, types.memory, in_memory, in_file, transfer, rows ? slab : &nothing) >= 0, path);
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
  const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  write_attribute(object, name, text.c_str(), {type, type});
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, const void* value, Types types)
{
  const Id scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Id made(
      H5Acreate_by_name(file_, object.c_str(), name.c_str(), types.file, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  agree(made.valid() && H5Awrite(made, types.memory, value) >= 0, object + ":" + name);
}

void Hdf5File::flush() { agree(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0, "what is buffered"); }
} // namespace pdx::io
