#include "pdx/io/hdf5_file.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/fingerprint.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/base/hdf5_id.hpp"
#include "pdx/base/machine_failure.hpp"
#include "pdx/io/provenance.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <fcntl.h>
#include <utility>

namespace pdx::io {
namespace {
static_assert(std::endian::native == std::endian::little, "values are put into files as they are in memory");

herr_t keep_deepest(unsigned, const H5E_error2_t* error, void* text)
{
  std::string& reason = *static_cast<std::string*>(text);
  if (reason.empty() && error->desc) reason = error->desc;
  return 0;
}

hid_t with_parents()
{
  const hid_t list = H5Pcreate(H5P_LINK_CREATE);
  H5Pset_create_intermediate_group(list, 1);
  return list;
}

hid_t create(Hdf5Journal& journal, const std::filesystem::path& path, bool sealed)
{
  const Hdf5Id access(journal.access(), H5Pclose), creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(creation, false);
  if (sealed) H5Pset_userblock(creation, Seal::kHeadBytes);
  return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, access);
}

hid_t open(Hdf5Journal& journal, const std::filesystem::path& path)
{
  const Hdf5Id access(journal.access(), H5Pclose);
  return H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
}

template <class T> std::span<const std::byte> bytes_of(std::span<const T> values) { return std::as_bytes(values); }
} // namespace

std::string hdf5_reason()
{
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_deepest, &reason);
  return reason.empty() ? "HDF5 gives no reason" : reason;
}

Hdf5File::Hdf5File(MPI_Comm comm, std::filesystem::path path, Mode mode)
    : comm_(comm), path_(std::move(path)), sealed_(mode == Mode::sealed)
{
  MPI_Comm_rank(comm_, &rank_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const bool fresh = mode != Mode::append;
  const std::string doing = fresh ? "cannot create" : "cannot open";
  Fault fault;
  if (rank_ == 0) {
    fault = path_fault(doing, path_, disk_.open(path_, fresh ? O_RDWR | O_CREAT | O_TRUNC : O_RDWR));
    if (!fault) {
      journal_ = std::make_unique<Hdf5Journal>(disk_);
      file_ = fresh ? create(*journal_, path_, sealed_) : open(*journal_, path_);
      if (file_ < 0) fault = {doing + " '" + path_.string() + "': " + hdf5_reason(), fresh};
    }
  }
  settle(comm_, fault);
  settle(comm_, rank_ ? path_fault(doing, path_, disk_.open(path_, O_WRONLY)) : Fault{});
  if (fresh)
    for (const auto& [name, value] : provenance(comm_)) attribute("/", name, value);
}

Hdf5File::~Hdf5File()
{
  int over = 0;
  MPI_Finalized(&over);
  if (!over && file_ >= 0) H5Fclose(file_); // into the journal, which goes with it
}

void Hdf5File::note(int code)
{
  if (!fault_) fault_ = disk_fault("cannot write", path_, code);
}

void Hdf5File::note_hdf5(bool ok, const std::string& what)
{
  if (!ok && !fault_) fault_ = {"cannot write " + what + " to '" + path_.string() + "': " + hdf5_reason(), true};
}

void Hdf5File::settle_all()
{
  try {
    settle(comm_, std::exchange(fault_, {}));
  } catch (const MachineFailure&) { // what was begun goes: it leaves room for the last words
    if (rank_ == 0 && !sealed_) (void)disk_.cut(journal_->whole_end());
    throw;
  }
}

void Hdf5File::group(const std::string& path)
{
  if (rank_) return;
  const Hdf5Id parents(with_parents(), H5Pclose);
  const Hdf5Id made(H5Gcreate2(file_, path.c_str(), parents, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  note_hdf5(made.valid(), path);
}

void Hdf5File::dataset(const std::string& path, std::span<const double> slab, int components)
{
  write_slab(path, bytes_of(slab), components, {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, "f64", 8});
}

void Hdf5File::dataset(const std::string& path, std::span<const int> slab, int components)
{
  write_slab(path, bytes_of(slab), components, {H5T_NATIVE_INT, H5T_STD_I32LE, "i32", 4});
}

void Hdf5File::dataset(const std::string& path, std::span<const std::uint64_t> slab, int components)
{
  write_slab(path, bytes_of(slab), components, {H5T_NATIVE_UINT64, H5T_STD_U64LE, "u64", 8});
}

void Hdf5File::link(const std::string& from, const std::string& path)
{
  if (rank_ || fault_) return;
  const Hdf5Id parents(with_parents(), H5Pclose);
  note_hdf5(H5Lcreate_hard(file_, from.c_str(), file_, path.c_str(), parents, H5P_DEFAULT) >= 0, path);
}

void Hdf5File::text(const std::string& path, std::string_view text)
{
  write_slab(path, bytes_of(std::span(rank_ ? std::string_view() : text)), 1,
             {H5T_NATIVE_UINT8, H5T_STD_U8LE, "u8", 1});
}

/// Where the dataset begins in the file; 0 if it has no values or could not be made.
std::uint64_t Hdf5File::make_dataset(const std::string& path, std::array<hsize_t, 2> extent, const Type& type)
{
  const Hdf5Id parents(with_parents(), H5Pclose);
  const Hdf5Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
  H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
  H5Pset_obj_track_times(creation, false);
  const Hdf5Id whole(H5Screate_simple(2, extent.data(), nullptr), H5Sclose);
  const Hdf5Id set(H5Dcreate2(file_, path.c_str(), type.file, whole, parents, creation, H5P_DEFAULT), H5Dclose);
  note_hdf5(set.valid(), path);
  const haddr_t at = set.valid() && extent[0] ? H5Dget_offset(set) : 0;
  note_hdf5(at != HADDR_UNDEF, path);
  return at == HADDR_UNDEF ? 0 : at;
}

void Hdf5File::write_slab(const std::string& path, std::span<const std::byte> slab, int components, const Type& type)
{
  const std::size_t row = type.bytes * static_cast<std::size_t>(components);
  unsigned long long mine = slab.size() / row, before = 0, all = 0;
  MPI_Exscan(&mine, &before, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  MPI_Allreduce(&mine, &all, 1, MPI_UNSIGNED_LONG_LONG, MPI_SUM, comm_);
  unsigned long long place[] = {0, 0}; // first byte, and whether there is one
  if (rank_ == 0 && !fault_) {
    place[0] = make_dataset(path, {all, static_cast<hsize_t>(components)}, type);
    place[1] = !fault_;
    if (sealed_ && !fault_)
      seal_.tables.push_back({path, type.name, static_cast<std::int64_t>(all), components, place[0]});
  }
  MPI_Bcast(place, 2, MPI_UNSIGNED_LONG_LONG, 0, comm_);
  if (!place[1]) settle_all();
  if (rank_ == 0) before = 0;
  const std::uint64_t at = place[0] + before * row;
  if (!fault_) note(disk_.write(slab, at));
  if (sealed_) seal_.cover(at, slab);
}

void Hdf5File::attribute(const std::string& object, const std::string& name, double value)
{
  write_attribute(object, name, &value, {H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, "f64", 8});
}

void Hdf5File::attribute(const std::string& object, const std::string& name, int value)
{
  write_attribute(object, name, &value, {H5T_NATIVE_INT, H5T_STD_I32LE, "i32", 4});
}

void Hdf5File::attribute(const std::string& object, const std::string& name, std::string_view value)
{
  if (rank_) return;
  const std::string text(value);
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, text.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  write_attribute(object, name, text.c_str(), {type, type, "text", text.size() + 1});
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, const void* value, const Type& type)
{
  if (rank_ || fault_) return;
  const Hdf5Id scalar(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id made(
      H5Acreate_by_name(file_, object.c_str(), name.c_str(), type.file, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  note_hdf5(made.valid() && H5Awrite(made, type.memory, value) >= 0, object + ":" + name);
}

void Hdf5File::flush()
{
  settle_all(); // values first: HDF5's side speaks of them
  if (rank_ == 0) {
    note_hdf5(H5Fflush(file_, H5F_SCOPE_GLOBAL) >= 0, "what is buffered");
    if (!fault_) note(journal_->put_on(disk_));
  }
  settle_all();
}

void Hdf5File::close()
{
  if (std::exchange(closed_, true)) return;
  settle_all();
  if (rank_ == 0) note_hdf5(H5Fclose(std::exchange(file_, H5I_INVALID_HID)) >= 0, "the end");
  if (sealed_)
    write_seal();
  else if (rank_ == 0 && !fault_)
    note(journal_->put_on(disk_));
  if (!fault_) note(disk_.sync());
  if (const int code = disk_.close(); !fault_) note(code);
  settle_all();
}

/// Fills what lies between the tables with HDF5's own bytes, and ends the file with the hashes of all.
void Hdf5File::write_seal()
{
  std::vector<Seal::Extent> all = gather_all(comm_, seal_.extents);
  if (rank_ || fault_) return;
  std::ranges::sort(all, {}, &Seal::Extent::at);
  seal_.extents.clear();
  const std::uint64_t end = journal_->end();
  std::uint64_t at = Seal::kHeadBytes;
  const auto fill = [&](std::uint64_t to) {
    std::vector<std::byte> gap(to - at);
    note(journal_->read(at, gap));
    note(disk_.write(gap, at));
    seal_.cover(at, gap);
    at = to;
  };
  for (const Seal::Extent& extent : all) {
    if (extent.at > at) fill(extent.at);
    seal_.extents.push_back(extent);
    at = extent.at + extent.bytes;
  }
  if (end > at) fill(end);
  const std::string table = seal_.text();
  const auto bytes = std::as_bytes(std::span(table));
  note(disk_.write(bytes, at));
  const SealHead head{Seal::kFormat, at, table.size(), hash_of(bytes)};
  const std::string text = head.text();
  if (!fault_) note(disk_.write(std::as_bytes(std::span(text)), 0));
}
} // namespace pdx::io
