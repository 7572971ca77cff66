#include "pdx/io/vtkhdf.hpp"

#include "pdx/base/hdf5_id.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/hdf5_file.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace pdx::io {
namespace {
constexpr const char* kFields = "fields.h5";
constexpr std::string_view kGrid = "UnstructuredGrid";
constexpr std::array<hsize_t, 6> kTensorOrder{0, 3, 5, 1, 4, 2}; // xx, yy, zz, xy, yz, xz in ours
constexpr int kVertex = 1, kQuadrilateral = 9;                   // types of cells
using Counts = std::vector<long long>;

struct NotSo : std::runtime_error {
  using std::runtime_error::runtime_error;
};

template <class Result> Result checked(Result result, const char* what)
{
  if (result < 0) throw NotSo(fmt::format("{}: {}", what, hdf5_reason()));
  return result;
}

/// A dataset of fields.h5.
struct Source {
  std::string path;
  haddr_t place = HADDR_UNDEF; // of its values in the file, by which names of one dataset are known
  hsize_t rows = 0, columns = 1;
  bool integer = false;
};

Source source_at(hid_t file, const std::string& path)
{
  const Hdf5Id set(checked(H5Dopen2(file, path.c_str(), H5P_DEFAULT), path.c_str()), H5Dclose);
  const Hdf5Id space(H5Dget_space(set), H5Sclose), type(H5Dget_type(set), H5Tclose);
  std::array<hsize_t, 2> extent{};
  if (H5Sget_simple_extent_ndims(space) != 2) throw NotSo(path + " is no table");
  checked(H5Sget_simple_extent_dims(space, extent.data(), nullptr), path.c_str());
  return {path, H5Dget_offset(set), extent[0], extent[1], H5Tget_class(type) == H5T_INTEGER};
}

/// One quantity of all steps: rows of its datasets one behind the other, each dataset once.
class Table {
public:
  /// First row of a dataset in the table.
  hsize_t place(const Source& source)
  {
    if (source.place != HADDR_UNDEF) {
      const auto [at, is_new] = starts_.emplace(source.place, rows_);
      if (!is_new) return at->second;
    }
    const hsize_t start = rows_;
    sources_.emplace_back(source, start);
    rows_ += source.rows;
    return start;
  }
  hsize_t rows() const { return rows_; }
  const Source& first() const { return sources_.front().first; }

  /// As views. `flat`: all numbers in one row.
  void write(hid_t group, const std::string& name, bool flat) const
  {
    const hsize_t columns = first().columns;
    const bool one = flat || columns == 1;
    const std::array<hsize_t, 2> extent{one ? rows_ * columns : rows_, columns};
    const Hdf5Id space(H5Screate_simple(one ? 1 : 2, extent.data(), nullptr), H5Sclose);
    const Hdf5Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    for (const auto& [source, start] : sources_) view(creation, space, source, start, one);
    const hid_t type = first().integer ? H5T_STD_I32LE : H5T_IEEE_F64LE;
    const Hdf5Id set(H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
    checked<hid_t>(set, name.c_str());
  }

private:
  static void view(hid_t creation, hid_t space, const Source& source, hsize_t start, bool one)
  {
    const std::array<hsize_t, 2> all{source.rows, source.columns};
    const Hdf5Id from(H5Screate_simple(2, all.data(), nullptr), H5Sclose);
    const auto map = [&] { checked(H5Pset_virtual(creation, space, kFields, source.path.c_str(), from), "a view"); };
    if (one) {
      const hsize_t first = start * source.columns, count = source.rows * source.columns;
      H5Sselect_hyperslab(space, H5S_SELECT_SET, &first, nullptr, &count, nullptr);
      return map();
    }
    for (hsize_t c = 0; c < source.columns; ++c) {
      const std::array<hsize_t, 2> to{start, c}, mine{0, source.columns == 6 ? kTensorOrder[c] : c},
          count{source.rows, 1};
      H5Sselect_hyperslab(space, H5S_SELECT_SET, to.data(), nullptr, count.data(), nullptr);
      H5Sselect_hyperslab(from, H5S_SELECT_SET, mine.data(), nullptr, count.data(), nullptr);
      map();
    }
  }

  std::vector<std::pair<Source, hsize_t>> sources_;
  std::map<haddr_t, hsize_t> starts_;
  hsize_t rows_ = 0;
};

/// Names below a group, in their order.
std::vector<std::string> names_in(hid_t file, const std::string& path)
{
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* all) {
    static_cast<std::vector<std::string>*>(all)->emplace_back(name);
    return herr_t{0};
  };
  checked(H5Literate_by_name(file, path.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, add, &names, H5P_DEFAULT),
          path.c_str());
  return names;
}

void write_numbers(hid_t group, const char* name, hid_t memory, hid_t stored, const void* values, hsize_t rows,
                   hsize_t columns = 0)
{
  const std::array<hsize_t, 2> extent{rows, columns};
  const Hdf5Id space(H5Screate_simple(columns ? 2 : 1, extent.data(), nullptr), H5Sclose);
  const Hdf5Id set(H5Dcreate2(group, name, stored, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
  checked<hid_t>(set, name);
  if (rows > 0) checked(H5Dwrite(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), name);
}

void write_counts(hid_t group, const char* name, const Counts& values, hsize_t columns = 0)
{
  write_numbers(group, name, H5T_NATIVE_LLONG, H5T_STD_I64LE, values.data(), values.size(), columns);
}

void write_attribute(hid_t group, const char* name, hid_t type, const void* value, hsize_t count = 0)
{
  const Hdf5Id space(count ? H5Screate_simple(1, &count, nullptr) : H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id made(H5Acreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  checked(H5Awrite(made, type, value), name);
}

/// Where the points, the cells and the values of a field begin, of each step.
struct Part {
  long long points = 0, cells = 0, first_point = 0, first_cell = 0;
  bool operator==(const Part&) const = default;
};

/// One block of all steps.
class Series {
public:
  void add(hid_t file, const std::string& block)
  {
    std::map<std::string, Source> tables;
    if (!block.empty())
      for (const std::string& name : names_in(file, block))
        tables.emplace(name, source_at(file, fmt::format("{}/{}", block, name)));
    steps_.push_back(std::move(tables));
  }

  void write(hid_t root, const std::vector<double>& times)
  {
    lay_out();
    constexpr std::array<long long, 2> version{2, 0};
    write_attribute(root, "Version", H5T_NATIVE_LLONG, version.data(), version.size());
    const Hdf5Id text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(text, kGrid.size());
    write_attribute(root, "Type", text, kGrid.data());
    write_cells(root);
    points_.write(root, "Points", false);
    const Hdf5Id of_points(H5Gcreate2(root, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    const Hdf5Id of_cells(H5Gcreate2(root, "CellData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    for (const auto& [name, field] : fields_) field.table.write(field.on_cells ? of_cells : of_points, name, false);
    write_steps(root, times);
  }

private:
  struct Field {
    bool on_cells = false;
    Table table;
    Counts starts;
  };

  void lay_out()
  {
    const auto there = std::ranges::find_if(steps_, [](const auto& tables) { return !tables.empty(); });
    corners_ = static_cast<long long>(there->at("cells").columns);
    for (const auto& [name, source] : *there)
      if (name != "points" && name != "cells" && name != "natural_point" && in_all(name))
        fields_[name].on_cells =
            source.rows == there->at("cells").rows && there->at("cells").rows != there->at("points").rows;
    for (const auto& tables : steps_) {
      Part part;
      if (!tables.empty())
        part = {static_cast<long long>(tables.at("points").rows), static_cast<long long>(tables.at("cells").rows),
                static_cast<long long>(points_.place(tables.at("points"))),
                static_cast<long long>(cells_.place(tables.at("cells")))};
      auto at = std::ranges::find(parts_, part);
      if (at == parts_.end()) at = parts_.insert(at, part);
      part_of_.push_back(at - parts_.begin());
      for (auto& [name, field] : fields_)
        field.starts.push_back(tables.empty() ? 0 : static_cast<long long>(field.table.place(tables.at(name))));
    }
  }
  bool in_all(const std::string& name) const
  {
    return std::ranges::all_of(steps_, [&](const auto& tables) { return tables.empty() || tables.contains(name); });
  }

  void write_cells(hid_t root) const
  {
    Counts points, cells, corners;
    std::vector<int> ends; // of the type of the cells' numbers
    for (const Part& part : parts_) {
      points.push_back(part.points);
      cells.push_back(part.cells);
      corners.push_back(corners_ * part.cells);
      for (long long c = 0; c <= part.cells; ++c) ends.push_back(static_cast<int>(corners_ * c));
    }
    const std::vector<unsigned char> types(cells_.rows(), corners_ == 1 ? kVertex : kQuadrilateral);
    write_counts(root, "NumberOfPoints", points);
    write_counts(root, "NumberOfCells", cells);
    write_counts(root, "NumberOfConnectivityIds", corners);
    write_numbers(root, "Offsets", H5T_NATIVE_INT, H5T_STD_I32LE, ends.data(), ends.size());
    write_numbers(root, "Types", H5T_NATIVE_UCHAR, H5T_STD_U8LE, types.data(), types.size());
    cells_.write(root, "Connectivity", true);
  }

  void write_steps(hid_t root, const std::vector<double>& times) const
  {
    const Hdf5Id steps(H5Gcreate2(root, "Steps", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    const auto count = static_cast<long long>(times.size());
    write_attribute(steps, "NSteps", H5T_NATIVE_LLONG, &count);
    write_numbers(steps, "Values", H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, times.data(), times.size());
    Counts points, cells, corners;
    for (const long long part : part_of_) {
      const Part& p = parts_[static_cast<std::size_t>(part)];
      points.push_back(p.first_point);
      cells.push_back(p.first_cell);
      corners.push_back(corners_ * p.first_cell);
    }
    write_counts(steps, "PartOffsets", part_of_);
    write_counts(steps, "NumberOfParts", Counts(times.size(), 1));
    write_counts(steps, "PointOffsets", points);
    write_counts(steps, "CellOffsets", cells, 1);
    write_counts(steps, "ConnectivityIdOffsets", corners, 1);
    const Hdf5Id of_points(H5Gcreate2(steps, "PointDataOffsets", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    const Hdf5Id of_cells(H5Gcreate2(steps, "CellDataOffsets", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
    for (const auto& [name, field] : fields_)
      write_counts(field.on_cells ? of_cells : of_points, name.c_str(), field.starts);
  }

  std::vector<std::map<std::string, Source>> steps_; // tables by name; none where the block is not there
  long long corners_ = 1;
  Table points_, cells_;
  std::map<std::string, Field> fields_;
  std::vector<Part> parts_;
  Counts part_of_;
};

/// The bytes of a file by its name.
std::map<std::string, std::string> described(const std::filesystem::path& directory)
{
  const std::filesystem::path path = directory / kFields;
  const Hdf5Id file(checked(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), kFields), H5Fclose);
  std::map<std::string, Series> series;
  std::vector<double> times;
  for (const std::string& step : names_in(file, "/")) {
    const std::vector<std::string> blocks = names_in(file, "/" + step);
    for (const std::string& block : blocks)
      if (const auto [at, is_new] = series.try_emplace(block); is_new)
        for (std::size_t k = 0; k < times.size(); ++k) at->second.add(file, "");
    for (auto& [block, one] : series)
      one.add(file, std::ranges::count(blocks, block) ? fmt::format("/{}/{}", step, block) : "");
    const Hdf5Id attribute(H5Aopen_by_name(file, step.c_str(), "time", H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    checked(H5Aread(attribute, H5T_NATIVE_DOUBLE, &times.emplace_back()), "time");
  }
  std::map<std::string, std::string> all;
  for (auto& [block, one] : series) {
    const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(access, 1 << 16, false); // in memory
    const Hdf5Id made(checked(H5Fcreate("vtkhdf", H5F_ACC_TRUNC, H5P_DEFAULT, access), "VTKHDF"), H5Fclose);
    {
      const Hdf5Id root(H5Gcreate2(made, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
      one.write(root, times);
    }
    checked(H5Fflush(made, H5F_SCOPE_LOCAL), "VTKHDF");
    std::string& bytes = all["fields_" + block + ".vtkhdf"];
    bytes.resize(static_cast<std::size_t>(checked(H5Fget_file_image(made, nullptr, 0), "VTKHDF")));
    checked(H5Fget_file_image(made, bytes.data(), bytes.size()), "VTKHDF");
  }
  return all;
}
} // namespace

void write_vtkhdf(MPI_Comm comm, const std::filesystem::path& directory)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  Fault fault;
  if (rank == 0) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    try {
      for (const auto& [name, bytes] : described(directory))
        if (fault = replace_file_alone(directory / name, bytes); fault) break;
    } catch (const NotSo& wrong) {
      fault = {fmt::format("cannot describe {}: {}", (directory / kFields).string(), wrong.what()), true};
    }
  }
  settle(comm, fault);
}
} // namespace pdx::io
