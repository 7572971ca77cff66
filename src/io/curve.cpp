#include "pdx/io/curve.hpp"

#include "pdx/io/agree.hpp"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <stdexcept>

namespace pdx::io {
namespace {
std::span<const std::byte> bytes_of(const std::string& text) { return std::as_bytes(std::span(text)); }

std::string header(const std::vector<Column>& columns)
{
  std::string line;
  for (const Column& column : columns)
    line += fmt::format("{}{} [{}]", line.empty() ? "" : ",", column.name, column.unit);
  return line;
}

/// The complete lines of a file, its header first, and then those with a first value up to `keep_to`.
std::vector<std::string> kept_lines(const std::filesystem::path& path, double keep_to)
{
  std::vector<std::string> lines;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line) && !file.eof(); lines.push_back(line))
    if (!lines.empty() && !(std::strtod(line.c_str(), nullptr) <= keep_to)) break;
  return lines;
}

/// Leaves in the file what is kept of it.
Fault shorten(const std::filesystem::path& path, const std::string& first, double keep_to)
{
  const std::vector<std::string> lines = kept_lines(path, keep_to);
  if (!lines.empty() && lines.front() != first)
    return {fmt::format("cannot go on with '{}': it has other columns: take another -output_dir", path.string()),
            false};
  return replace_file_alone(path, fmt::format("{}\n", fmt::join(lines.empty() ? std::vector{first} : lines, "\n")));
}
} // namespace

Curve::Curve(MPI_Comm comm, std::filesystem::path path, const std::vector<Column>& columns,
             std::optional<double> keep_to)
    : comm_(comm), path_(std::move(path)), columns_(columns.size())
{
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  Fault fault;
  if (rank == 0) {
    const std::string first = header(columns);
    if (keep_to) fault = shorten(path_, first, *keep_to);
    const int fresh = keep_to ? 0 : O_CREAT | O_TRUNC;
    if (!fault) fault = path_fault("cannot create", path_, file_.open(path_, O_WRONLY | fresh));
    if (!fault && !keep_to) fault = disk_fault("cannot write", path_, file_.append(bytes_of(first + "\n")));
  }
  settle(comm_, fault);
}

void Curve::row(std::span<const double> values)
{
  Fault fault;
  if (file_.is_open()) {
    if (values.size() != columns_)
      throw std::logic_error(fmt::format("{} values for {} columns of '{}'", values.size(), columns_, path_.string()));
    const int code = file_.is_linked() ? file_.append(bytes_of(fmt::format("{}\n", fmt::join(values, ",")))) : ENOENT;
    fault = disk_fault("cannot write", path_, code);
  }
  settle(comm_, fault);
}

void Curve::close()
{
  int code = file_.is_open() ? file_.sync() : 0;
  if (const int at_end = file_.close(); !code) code = at_end;
  settle(comm_, disk_fault("cannot write", path_, code));
}
} // namespace pdx::io
