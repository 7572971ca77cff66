#include "pdx/io/snapshot.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/hdf5_id.hpp"
#include "pdx/base/trial.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/xdmf.hpp"

#include <array>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace pdx::io {
namespace {
constexpr const char* kDataFile = "fields.h5";
constexpr const char* kXdmfFile = "fields.xdmf";
constexpr unsigned kMostSeconds = 60; // that HDF5 may take to find its way in a file, which may be damaged

std::size_t cell_count(const field::OutputBlock& block)
{
  return block.quadrilaterals ? block.cells.size() / 4 : block.natural_point.size();
}

bool consistent(const field::OutputBlock& block)
{
  const std::size_t points = block.natural_point.size();
  bool ok = block.points.size() == 3 * points && block.cells.size() % 4 == 0;
  for (const field::OutputField& field : block.fields)
    ok = ok &&
         field.values.size() == static_cast<std::size_t>(field.rank) * (field.on_cells ? cell_count(block) : points);
  return ok;
}

/// "displacement [m]" in two: the name fit for a dataset, and what stands in the brackets.
struct NameAndUnit {
  std::string name, unit;
};
NameAndUnit split(const std::string& full)
{
  const auto open = full.find('['), close = full.rfind(']');
  NameAndUnit parts{full.substr(0, open), ""};
  if (open != std::string::npos && close != std::string::npos && close > open)
    parts.unit = full.substr(open + 1, close - open - 1);
  while (!parts.name.empty() && parts.name.back() == ' ') parts.name.pop_back();
  for (char& c : parts.name)
    if (c == ' ' || c == '/') c = '_';
  return parts;
}

/// Sizes of a block over all ranks, and where ours begins.
struct Extent {
  std::int64_t points = 0, cells = 0, inconsistent = 0, first_point = 0;
};
std::vector<Extent> extents(MPI_Comm comm, std::span<const field::OutputBlock> blocks)
{
  std::vector<Extent> all;
  for (const field::OutputBlock& block : blocks) {
    const auto points = static_cast<std::int64_t>(block.natural_point.size());
    std::array<std::int64_t, 3> sum{points, static_cast<std::int64_t>(cell_count(block)), !consistent(block)};
    std::int64_t before = 0;
    MPI_Exscan(&points, &before, 1, MPI_INT64_T, MPI_SUM, comm);
    MPI_Allreduce(MPI_IN_PLACE, sum.data(), 3, MPI_INT64_T, MPI_SUM, comm);
    all.push_back({sum[0], sum[1], sum[2], before});
  }
  for (std::size_t b = 0; b < all.size(); ++b)
    if (all[b].inconsistent)
      throw std::logic_error("output block '" + blocks[b].name +
                             "': the size of a field does not fit its points or cells");
  return all;
}

/// Writes tables into one step of a file, or links them to where the file has them already.
class StepWriter {
public:
  StepWriter(Hdf5File& file, KeptTables& kept, std::string step) : file_(file), kept_(kept), step_(std::move(step)) {}

  XdmfGrid block(const field::OutputBlock& block, const Extent& extent)
  {
    XdmfGrid grid{block.name, step_ + "/" + block.name, extent.points, extent.cells, block.quadrilaterals, {}};
    table<double>(block.name + "/points", block.points, 3);
    table<int>(block.name + "/natural_point", block.natural_point, 1);
    if (block.quadrilaterals)
      table<int>(block.name + "/cells", block.cells, 4);
    else {
      std::vector<int> vertices(block.natural_point.size());
      std::iota(vertices.begin(), vertices.end(), static_cast<int>(extent.first_point));
      table<int>(block.name + "/cells", vertices, 1);
    }
    for (const field::OutputField& field : block.fields) grid.attributes.push_back(attribute(block.name, field));
    return grid;
  }
  std::int64_t staying() const { return staying_; } ///< bytes here of places, cells and codes

private:
  /// True if it was written and not linked.
  template <class Number> bool table(const std::string& name, std::span<const Number> slab, int components)
  {
    const std::string path = step_ + "/" + name, from = kept_.place(file_.comm(), name, std::as_bytes(slab), path);
    if (std::is_same_v<Number, int> || name.ends_with("/points"))
      staying_ += static_cast<std::int64_t>(slab.size_bytes());
    if (from == path)
      file_.dataset(path, slab, components);
    else
      file_.link(from, path);
    return from == path;
  }

  XdmfAttribute attribute(const std::string& block, const field::OutputField& field)
  {
    const NameAndUnit parts = split(field.name);
    const std::string name = block + "/" + parts.name;
    const int components = static_cast<int>(field.rank);
    const std::vector<int> codes(field.values.begin(), field.integer ? field.values.end() : field.values.begin());
    if (field.integer ? table<int>(name, codes, components) : table<double>(name, field.values, components))
      file_.attribute(step_ + "/" + name, "unit", parts.unit);
    return {field.name, parts.name, components, field.on_cells, field.integer};
  }

  Hdf5File& file_;
  KeptTables& kept_;
  std::string step_;
  std::int64_t staying_ = 0;
};

std::string step_name(int step) { return fmt::format("/step{:06d}", step); }

/// Takes all steps but the first ones out of an open file; false if it has not that many.
bool keep_first(hid_t file, int steps)
{
  const auto has = [&](int step) { return H5Lexists(file, step_name(step).c_str(), H5P_DEFAULT) > 0; };
  for (int step = 0; step < steps; ++step)
    if (!has(step)) return false;
  bool ok = true;
  for (int step = steps; ok && has(step); ++step) ok = H5Ldelete(file, step_name(step).c_str(), H5P_DEFAULT) >= 0;
  return ok && H5Fflush(file, H5F_SCOPE_GLOBAL) >= 0;
}

bool shorten(const std::filesystem::path& path, int steps, bool in_earnest)
{
  DiskFile disk;
  if (disk.open(path, O_RDWR)) return false;
  Hdf5Journal journal(disk);
  const Hdf5Id access(journal.access(), H5Pclose);
  const Hdf5Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, access), H5Fclose);
  return file.valid() && keep_first(file, steps) && (!in_earnest || journal.put_on(disk) == 0);
}

/// Cuts the file down to its first steps, or puts it aside; true if there is something to go on with. Collective.
bool keep_steps(MPI_Comm comm, const std::filesystem::path& directory, int steps)
{
  int rank = 0, kept = 0;
  MPI_Comm_rank(comm, &rank);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  if (rank == 0 && steps > 0) {
    const std::filesystem::path path = directory / kDataFile;
    const bool sound = try_apart([&] { (void)shorten(path, steps, false); }, kMostSeconds).empty();
    kept = sound && shorten(path, steps, true);
    std::error_code none;
    if (!kept) std::filesystem::rename(path, directory / "fields_before.h5", none);
  }
  MPI_Bcast(&kept, 1, MPI_INT, 0, comm);
  return kept != 0;
}

std::filesystem::path made(MPI_Comm comm, const std::filesystem::path& directory)
{
  create_directory(comm, directory);
  return directory;
}
} // namespace

FieldsFile::FieldsFile(MPI_Comm comm, const std::filesystem::path& directory, int steps)
    : comm_(comm), directory_(made(comm, directory)), fresh_(!keep_steps(comm, directory_, steps)),
      file_(comm, directory_ / kDataFile, fresh_ ? Hdf5File::Mode::create : Hdf5File::Mode::append)
{
  if (fresh_) return;
  steps_ = steps;
  std::ifstream file(directory_ / kXdmfFile);
  xdmf_ = xdmf_first_steps(std::string(std::istreambuf_iterator<char>(file), {}), steps);
}

void FieldsFile::write(double time, std::span<const field::OutputBlock> blocks)
{
  const std::vector<Extent> sizes = extents(comm_, blocks);
  const std::string step = step_name(steps_);
  std::vector<XdmfGrid> grids;
  {
    static Event event("io_fields");
    const Timed timed(event);
    file_.group(step);
    file_.attribute(step, "time", time);
    StepWriter writer(file_, kept_, step);
    for (std::size_t b = 0; b < blocks.size(); ++b)
      if (sizes[b].points > 0) grids.push_back(writer.block(blocks[b], sizes[b]));
    staying_ = writer.staying();
    MPI_Allreduce(MPI_IN_PLACE, &staying_, 1, MPI_INT64_T, MPI_SUM, comm_);
    file_.flush();
  }
  ++steps_;
  static Event event("io_xdmf");
  const Timed timed(event);
  xdmf_ += xdmf_step(kDataFile, time, grids);
  replace_file(comm_, directory_ / kXdmfFile, xdmf_document(xdmf_));
}
} // namespace pdx::io
