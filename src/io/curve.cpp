#include "pdx/io/curve.hpp"

#include "pdx/base/error.hpp"
#include "pdx/io/agree.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <fstream>

namespace pdx::io {
namespace {
/// Why the line could not be written, "" if it was.
std::string put_line(std::FILE* file, const std::string& line)
{
  const bool ok = std::fputs(line.c_str(), file) >= 0 && std::fputc('\n', file) >= 0 && std::fflush(file) == 0;
  return ok ? "" : std::strerror(errno);
}

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

/// Leaves in the file what is kept of it; why it cannot, "" if it did.
std::string shorten(const std::filesystem::path& path, const std::string& first, double keep_to)
{
  const std::vector<std::string> lines = kept_lines(path, keep_to);
  if (!lines.empty() && lines.front() != first) return "it has other columns: take another -output_dir";
  std::ofstream file(path.string() + ".part", std::ios::trunc);
  file << fmt::format("{}\n", lines.empty() ? first : fmt::format("{}", fmt::join(lines, "\n")));
  file.close();
  if (!file || std::rename((path.string() + ".part").c_str(), path.c_str()) != 0) return std::strerror(errno);
  return "";
}

std::string begin(const std::filesystem::path& path, const std::string& first, std::optional<double> keep_to)
{
  if (keep_to) return shorten(path, first, *keep_to);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "w"), std::fclose);
  return file ? put_line(file.get(), first) : std::strerror(errno);
}
} // namespace

Curve::Curve(MPI_Comm comm, std::filesystem::path path, const std::vector<Column>& columns,
             std::optional<double> keep_to)
    : comm_(comm), path_(std::move(path)), columns_(columns.size()), file_(nullptr, std::fclose)
{
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  std::string reason;
  if (rank == 0) {
    reason = begin(path_, header(columns), keep_to);
    if (reason.empty()) file_.reset(std::fopen(path_.c_str(), "a"));
    if (reason.empty() && !file_) reason = std::strerror(errno);
  }
  reason = first_message(comm_, reason);
  if (!reason.empty())
    throw UserError((keep_to ? "cannot go on with '" : "cannot create '") + path_.string() + "': " + reason);
}

void Curve::row(std::span<const double> values)
{
  std::string reason;
  if (file_) {
    reason = values.size() == columns_ ? put_line(file_.get(), fmt::format("{}", fmt::join(values, ",")))
                                       : fmt::format("{} values for {} columns", values.size(), columns_);
  }
  reason = first_message(comm_, reason);
  if (!reason.empty()) throw SolverFailure("cannot write '" + path_.string() + "': " + reason);
}
} // namespace pdx::io
