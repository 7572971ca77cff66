#include "pdx/io/hdf5_journal.hpp"

#include "pdx/base/hdf5_id.hpp"

#include <algorithm>
#include <new>

namespace pdx::io {
/// What HDF5 holds; one it never gave back outlives its journal.
struct Hdf5Journal::Channel {
  H5FD_t base{}; // HDF5's part, first
  Hdf5Journal* journal = nullptr;
  haddr_t given_out = 0;

  static Channel& of(H5FD_t* file) { return *reinterpret_cast<Channel*>(file); }
  static const Channel& of(const H5FD_t* file) { return *reinterpret_cast<const Channel*>(file); }

  static H5FD_t* open(const char*, unsigned, hid_t access, haddr_t)
  {
    const void* given = H5Pget_driver_info(access);
    if (!given) return nullptr;
    auto* channel = new (std::nothrow) Channel;
    if (!channel) return nullptr;
    channel->journal = *static_cast<Hdf5Journal* const*>(given);
    channel->journal->channel_ = channel;
    return &channel->base;
  }

  static herr_t close(H5FD_t* file)
  {
    if (of(file).journal) of(file).journal->channel_ = nullptr;
    delete &of(file);
    return 0;
  }

  static herr_t query(const H5FD_t*, unsigned long* flags)
  {
    *flags = H5FD_FEAT_AGGREGATE_METADATA;
    return 0;
  }

  static haddr_t get_given_out(const H5FD_t* file, H5FD_mem_t) { return of(file).given_out; }

  static herr_t set_given_out(H5FD_t* file, H5FD_mem_t, haddr_t end)
  {
    of(file).given_out = end;
    if (of(file).journal) of(file).journal->end_ = std::max<std::uint64_t>(of(file).journal->end_, end);
    return 0;
  }

  static haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t)
  {
    return of(file).journal ? std::max<haddr_t>(of(file).journal->end_, of(file).given_out) : of(file).given_out;
  }

  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* bytes)
  {
    if (!of(file).journal) return -1;
    return of(file).journal->read(at, {static_cast<std::byte*>(bytes), size}) ? -1 : 0;
  }

  static herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, const void* bytes)
  {
    try {
      if (of(file).journal) of(file).journal->write(at, {static_cast<const std::byte*>(bytes), size});
      return 0; // an orphan has no file any more
    } catch (...) {
      return -1;
    }
  }

  static hid_t driver()
  {
    H5FD_class_t c{};
#if H5_VERSION_GE(1, 13, 0)
    c.version = H5FD_CLASS_VERSION;
    c.value = 600; // of those free for programs
#endif
    c.name = "pdx_journal";
    c.maxaddr = haddr_t{1} << 62;
    c.fc_degree = H5F_CLOSE_STRONG;
    c.fapl_size = sizeof(Hdf5Journal*);
    c.open = open;
    c.close = close;
    c.query = query;
    c.get_eoa = get_given_out;
    c.set_eoa = set_given_out;
    c.get_eof = end_of_file;
    c.read = read;
    c.write = write;
    static const hid_t id = H5FDregister(&c);
    return id;
  }
};

Hdf5Journal::~Hdf5Journal()
{
  if (channel_) channel_->journal = nullptr;
}

hid_t Hdf5Journal::access()
{
  const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
  const Hdf5Journal* const self = this;
  H5Pset_libver_bounds(list, H5F_LIBVER_V18, H5F_LIBVER_V18);
  if (H5Pset_driver(list, Channel::driver(), &self) >= 0) return list;
  H5Pclose(list);
  return H5I_INVALID_HID;
}

void Hdf5Journal::write(std::uint64_t at, std::span<const std::byte> bytes)
{
  if (bytes.empty()) return;
  std::vector<std::byte> joined;
  std::uint64_t first = at;
  auto next = pieces_.upper_bound(at);
  if (next != pieces_.begin())
    if (const auto before = std::prev(next); before->first + before->second.size() >= at) {
      joined = std::move(before->second);
      first = before->first;
      next = before;
    }
  joined.resize(std::max<std::size_t>(joined.size(), at - first + bytes.size()));
  std::ranges::copy(bytes, joined.begin() + static_cast<std::ptrdiff_t>(at - first));
  while (next != pieces_.end() && next->first <= first + joined.size()) {
    const std::uint64_t end = first + joined.size();
    if (next->first != first && next->first + next->second.size() > end)
      joined.insert(joined.end(), next->second.begin() + static_cast<std::ptrdiff_t>(end - next->first),
                    next->second.end());
    next = pieces_.erase(next);
  }
  end_ = std::max(end_, first + joined.size());
  pieces_[first] = std::move(joined);
}

int Hdf5Journal::read(std::uint64_t at, std::span<std::byte> bytes) const
{
  std::ranges::fill(bytes, std::byte{0});
  const std::uint64_t on_disk = disk_.is_open() ? disk_.size() : 0;
  if (at < on_disk)
    if (const int code = disk_.read(bytes.first(std::min<std::uint64_t>(bytes.size(), on_disk - at)), at)) return code;
  for (const auto& [first, piece] : pieces_) {
    const std::uint64_t from = std::max(first, at), to = std::min(first + piece.size(), at + bytes.size());
    if (from < to)
      std::ranges::copy(std::span(piece).subspan(from - first, to - from),
                        bytes.begin() + static_cast<std::ptrdiff_t>(from - at));
  }
  return 0;
}

int Hdf5Journal::put_on(DiskFile& disk)
{
  if (const int code = disk.extend(end_)) return code;
  const auto put = [&](const Pieces::value_type& piece) { return disk.write(piece.second, piece.first); };
  for (const auto& piece : pieces_)
    if (piece.first >= old_end_)
      if (const int code = put(piece)) return code;
  for (auto piece = pieces_.rbegin(); piece != pieces_.rend(); ++piece) // the head of the file comes last
    if (piece->first < old_end_)
      if (const int code = put(*piece)) return code;
  pieces_.clear();
  old_end_ = end_;
  return 0;
}
} // namespace pdx::io
