#include "gmsh_source.hpp"

#include "pdx/base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sstream>

namespace pdx::mesh {
namespace {
bool blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
bool line_end(char c) { return c == '\n' || c == '\r'; }

std::string whole_file(const std::string& option, const std::string& file)
{
  const auto refuse = [&](const char* what) { throw UserError(fmt::format("{} {}: {}", option, file, what)); };
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse("there is no such file: check the path");
  if (std::filesystem::is_directory(status)) refuse("this is a directory: give a Gmsh file");
  if (!std::filesystem::is_regular_file(status)) refuse("this is no regular file: give a Gmsh file");
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream bytes;
  if (stream.peek() != std::ifstream::traits_type::eof()) bytes << stream.rdbuf();
  if (!stream.is_open() || stream.bad() || !bytes) refuse("the file cannot be read: check its permissions");
  return std::move(bytes).str();
}
} // namespace

std::string shown(std::string_view word)
{
  constexpr std::size_t kLongest = 40;
  std::string text;
  for (const char c : word.substr(0, kLongest))
    if (c >= ' ' && c <= '~')
      text += c;
    else
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  return word.size() > kLongest ? text + "..." : text;
}

GmshSource::GmshSource(std::string file, std::string option)
    : option_(std::move(option)), file_(std::move(file)), bytes_(whole_file(option_, file_))
{
  if (bytes_.starts_with("\xef\xbb\xbf")) here_ = 3;
}

/// Lines end with LF, CR LF or CR.
std::string GmshSource::where(std::size_t place) const
{
  if (binary_) return fmt::format("byte {}", place);
  std::size_t line = 1;
  for (std::size_t k = 0; k < std::min(place, bytes_.size()); ++k)
    line += bytes_[k] == '\n' || (bytes_[k] == '\r' && (k + 1 == bytes_.size() || bytes_[k + 1] != '\n'));
  return fmt::format("line {}", line);
}

std::string GmshSource::name() const { return fmt::format("{} {}", option_, file_); }

void GmshSource::refuse(const std::string& what) const { refuse_at(last_, what); }

void GmshSource::refuse_at(std::size_t place, const std::string& what) const
{
  throw UserError(fmt::format("{}: {}: {}", name(), where(place), what));
}

void GmshSource::skip_blanks()
{
  while (here_ < bytes_.size() && blank(bytes_[here_])) ++here_;
}

std::string_view GmshSource::word()
{
  skip_blanks();
  last_ = here_;
  while (here_ < bytes_.size() && !blank(bytes_[here_])) ++here_;
  return std::string_view(bytes_).substr(last_, here_ - last_);
}

std::string_view GmshSource::line()
{
  while (here_ < bytes_.size() && (bytes_[here_] == ' ' || bytes_[here_] == '\t')) ++here_;
  last_ = here_;
  while (here_ < bytes_.size() && !line_end(bytes_[here_])) ++here_;
  std::string_view rest = std::string_view(bytes_).substr(last_, here_ - last_);
  while (!rest.empty() && blank(rest.back())) rest.remove_suffix(1);
  return rest;
}

void GmshSource::end_line()
{
  if (const std::string_view rest = line(); !rest.empty())
    refuse(fmt::format("\"{}\" where a line should end: write the file again", shown(rest)));
  if (here_ < bytes_.size() && bytes_[here_] == '\r') ++here_;
  if (here_ < bytes_.size() && bytes_[here_] == '\n') ++here_;
}

void GmshSource::expect(std::string_view title)
{
  const std::string_view found = word();
  if (found.empty()) refuse(fmt::format("the file ends before {}: write it again", title));
  if (found != title) refuse(fmt::format("\"{}\" where {} belongs: write the file again", shown(found), title));
}

void GmshSource::skip_section(std::string_view title, std::span<const std::string_view> sections)
{
  const std::size_t begin = last_;
  const std::string end = fmt::format("$End{}", title.substr(1));
  const std::string_view text = bytes_;
  for (std::size_t at = text.find('$', here_); at != std::string_view::npos; at = text.find('$', at + 1)) {
    if (!line_end(text[at - 1])) continue;
    here_ = at;
    const std::string_view found = word();
    if (found == end) return;
    if (!binary_ && std::find(sections.begin(), sections.end(), found) != sections.end())
      refuse(fmt::format("{} begins before {}: write the file again", found, end));
  }
  refuse_at(begin, fmt::format("{} is not closed by {}: write the file again", shown(title), shown(end)));
}

std::int64_t GmshSource::text_number()
{
  std::string_view found = word();
  const std::string_view given = found;
  if (found.empty()) refuse("the file ends too early: write it again");
  if (found[0] == '+') found.remove_prefix(1);
  std::int64_t value = 0;
  const auto result = std::from_chars(found.data(), found.data() + found.size(), value);
  if (result.ec != std::errc{} || result.ptr != found.data() + found.size())
    refuse(fmt::format("\"{}\" where a whole number belongs: write the file again", shown(given)));
  return value;
}

template <class Value> Value GmshSource::raw()
{
  last_ = here_;
  if (bytes_.size() - here_ < sizeof(Value)) refuse("the file ends too early: write it again");
  Value value{};
  std::memcpy(&value, bytes_.data() + here_, sizeof(Value));
  here_ += sizeof(Value);
  return value;
}

std::int64_t GmshSource::small()
{
  if (binary_) return raw<std::int32_t>();
  const std::int64_t value = text_number();
  if (value != static_cast<std::int32_t>(value))
    refuse(fmt::format("{} where a number of 32 bits belongs: write the file again", value));
  return value;
}

std::int64_t GmshSource::large() { return binary_ ? raw<std::int64_t>() : text_number(); }

double GmshSource::real()
{
  double value = 0.0;
  if (binary_) {
    value = raw<double>();
  } else {
    std::string_view found = word();
    const std::string_view given = found;
    if (found.empty()) refuse("the file ends too early: write it again");
    if (found[0] == '+') found.remove_prefix(1);
    const auto result = std::from_chars(found.data(), found.data() + found.size(), value);
    if (result.ec != std::errc{} || result.ptr != found.data() + found.size())
      refuse(fmt::format("\"{}\" where a coordinate belongs: write the file again", shown(given)));
  }
  if (!std::isfinite(value)) refuse("a coordinate is no finite number: write the file again");
  return value;
}

std::size_t GmshSource::count(std::int64_t value, std::size_t values) const
{
  const std::size_t least = values * (binary_ ? 4 : 2); // bytes
  if (value < 0 || static_cast<std::uint64_t>(value) > (bytes_.size() - here_ + 1) / least)
    refuse(fmt::format("a count of {} cannot be right: write the file again", value));
  return static_cast<std::size_t>(value);
}

void GmshSource::skip(std::size_t reals)
{
  for (std::size_t k = 0; k < reals; ++k) (void)real();
}
} // namespace pdx::mesh
