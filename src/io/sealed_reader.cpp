#include "pdx/io/sealed_reader.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/fingerprint.hpp"
#include "pdx/io/agree.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>

namespace pdx::io {
namespace {
constexpr std::uint64_t kMostTable = std::uint64_t{1} << 30; // [B]
constexpr std::string_view kHdf5Mark = "\x89HDF\r\n\x1a\n";

std::span<std::byte> bytes_of(std::string& text) { return std::as_writable_bytes(std::span(text)); }

/// What older versions left: plain HDF5 with their format in the text of the scene.
std::string why_no_head(const std::string& head, const DiskFile& file)
{
  if (!head.starts_with(kHdf5Mark)) return "it is no checkpoint of pdxsolve";
  std::string start(std::min<std::uint64_t>(file.size(), 1 << 20), '\0');
  if (file.read(bytes_of(start), 0)) return "it is no checkpoint of pdxsolve";
  constexpr std::string_view mark = "format = ";
  const std::size_t at = start.find(mark);
  if (at == std::string::npos || at + mark.size() >= start.size())
    return "it is an HDF5 file, but no checkpoint of pdxsolve";
  return fmt::format("it is a checkpoint of format {}, of an older version: this one reads format {}; go on with the "
                     "version that wrote it, or begin anew",
                     start[at + mark.size()] - '0', Seal::kFormat);
}

/// Text of the seal of an open file; why there is none in `why`.
std::string table_text(const DiskFile& file, std::string& why)
{
  constexpr const char* cut = "it is damaged: cut off, or grown";
  std::string head(Seal::kHeadBytes, '\0'), table;
  if (!file.is_regular()) return why = "it is no file", table;
  if (file.size() < head.size() || file.read(bytes_of(head), 0)) return why = "it is too short for a checkpoint", table;
  const std::optional<SealHead> told = SealHead::from(head);
  if (!told) return why = why_no_head(head, file), table;
  if (told->format != Seal::kFormat &&
      SealHead{told->format, told->table_at, told->table_bytes, told->table_hash}.text() == head)
    return why = fmt::format("it has format {}, this version reads {}", told->format, Seal::kFormat), table;
  if (told->text() != head) return why = "its head is damaged", table;
  if (told->table_bytes > kMostTable || told->table_at > file.size() ||
      told->table_bytes != file.size() - told->table_at)
    return why = cut, table;
  table.resize(told->table_bytes);
  if (const int code = file.read(bytes_of(table), told->table_at)) return why = std::strerror(code), table;
  if (hash_of(std::as_bytes(std::span(table))) != told->table_hash) why = "its table of contents is damaged";
  return table;
}
} // namespace

SealedReader::SealedReader(MPI_Comm comm, std::filesystem::path path) : comm_(comm), path_(std::move(path))
{
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  std::error_code none;
  std::string table, why;
  unsigned long long size[] = {0, 0};
  if (rank == 0) {
    if (!std::filesystem::exists(path_, none))
      why = "there is no such file";
    else if (!std::filesystem::is_regular_file(path_, none))
      why = "it is no file";
  }
  why = first_message(comm_, why);
  if (why.empty()) {
    const int code = disk_.open(path_, O_RDONLY);
    why = first_message(comm_, code ? std::strerror(code) : "");
  }
  if (why.empty()) {
    if (rank == 0) table = table_text(disk_, why);
    why = first_message(comm_, why);
  }
  if (why.empty()) {
    size[0] = table.size();
    size[1] = disk_.size();
    MPI_Bcast(size, 2, MPI_UNSIGNED_LONG_LONG, 0, comm_);
    table.resize(size[0]);
    MPI_Bcast(table.data(), static_cast<int>(size[0]), MPI_CHAR, 0, comm_);
    std::optional<Seal> seal = Seal::from(table, size[1] - size[0]);
    why = first_message(comm_, seal ? "" : "its table of contents is damaged");
    if (seal) seal_ = std::move(*seal);
  }
  if (!why.empty()) throw UserError(fmt::format("cannot read '{}': {}", path_.string(), why));
  check_bytes();
}

/// Ranks share the work.
void SealedReader::check_bytes() const
{
  int rank = 0, size = 1;
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &size);
  std::vector<std::byte> bytes;
  std::string name, why;
  for (auto k = static_cast<std::size_t>(rank); k < seal_.extents.size() && why.empty();
       k += static_cast<std::size_t>(size)) {
    const Seal::Extent& extent = seal_.extents[k];
    bytes.resize(extent.bytes);
    const int code = disk_.read(bytes, extent.at);
    if (!code && hash_of(bytes) == extent.hash) continue;
    name = seal_.name_at(extent.at);
    why = (name.empty() ? "HDF5's own part" : "dataset " + name) +
          (code ? fmt::format(" cannot be read: {}", std::strerror(code)) : " is damaged: its hash is another");
  }
  why = first_message(comm_, why);
  if (!why.empty()) throw UserError(fmt::format("cannot read '{}': {}", path_.string(), why));
}

void SealedReader::require(const std::string& name, const std::string& why) const
{
  const std::string first = first_message(comm_, why);
  if (!first.empty()) throw UserError(fmt::format("cannot read '{}': dataset {} {}", path_.string(), name, first));
}

const Seal::Table* SealedReader::find(const std::string& name) const
{
  const auto found = std::ranges::find(seal_.tables, name, &Seal::Table::name);
  return found == seal_.tables.end() ? nullptr : &*found;
}

const Seal::Table& SealedReader::table(const std::string& name, std::string_view type) const
{
  const Seal::Table* found = find(name);
  if (!found) throw UserError(fmt::format("cannot read '{}': it has no dataset {}", path_.string(), name));
  if (found->type != type)
    throw UserError(
        fmt::format("cannot read '{}': dataset {} holds {}, not {}", path_.string(), name, found->type, type));
  return *found;
}

std::array<std::int64_t, 2> SealedReader::shape(const std::string& name) const
{
  const Seal::Table* found = find(name);
  if (!found) throw UserError(fmt::format("cannot read '{}': it has no dataset {}", path_.string(), name));
  return {found->rows, found->columns};
}

void SealedReader::read(const std::string& name, std::int64_t first, int components, std::span<double> slab) const
{
  read_slab(table(name, "f64"), first, components, std::as_writable_bytes(slab));
  const auto bad = std::ranges::find_if(slab, [](double value) { return !std::isfinite(value); });
  require(name, bad == slab.end() ? "" : fmt::format("holds {}: must be a finite number", *bad));
}

void SealedReader::read(const std::string& name, std::int64_t first, int components,
                        std::span<std::uint64_t> slab) const
{
  read_slab(table(name, "u64"), first, components, std::as_writable_bytes(slab));
}

void SealedReader::read_slab(const Seal::Table& table, std::int64_t first, int components,
                             std::span<std::byte> slab) const
{
  const auto width = 8 * static_cast<std::uint64_t>(components);
  const auto rows = static_cast<std::int64_t>(slab.size() / width);
  const bool fits = table.columns == components && first >= 0 && first + rows <= table.rows;
  require(table.name,
          fits ? "" : fmt::format("has {} x {} numbers, too few or of another kind", table.rows, table.columns));
  const int code = slab.empty() ? 0 : disk_.read(slab, table.at + static_cast<std::uint64_t>(first) * width);
  require(table.name, code ? std::strerror(code) : "");
}

std::vector<double> SealedReader::column(const std::string& name) const
{
  std::vector<double> values(static_cast<std::size_t>(table(name, "f64").rows));
  read(name, 0, 1, std::span<double>(values));
  return values;
}

std::string SealedReader::text(const std::string& name) const
{
  const Seal::Table& found = table(name, "u8");
  std::string text(found.bytes(), '\0');
  const int code = text.empty() ? 0 : disk_.read(bytes_of(text), found.at);
  require(name, code ? std::strerror(code) : "");
  return text;
}
} // namespace pdx::io
