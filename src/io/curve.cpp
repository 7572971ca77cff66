#include "pdx/io/curve.hpp"

#include "pdx/base/error.hpp"
#include "pdx/io/agree.hpp"

#include <cerrno>
#include <cstring>
#include <fmt/format.h>

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
} // namespace

Curve::Curve(MPI_Comm comm, std::filesystem::path path, const std::vector<Column>& columns)
    : comm_(comm), path_(std::move(path)), columns_(columns.size()), file_(nullptr, std::fclose)
{
  int rank = 0;
  MPI_Comm_rank(comm_, &rank);
  std::string reason;
  if (rank == 0) {
    file_.reset(std::fopen(path_.c_str(), "w"));
    reason = file_ ? put_line(file_.get(), header(columns)) : std::strerror(errno);
  }
  reason = first_message(comm_, reason);
  if (!reason.empty()) throw UserError("cannot create '" + path_.string() + "': " + reason);
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
