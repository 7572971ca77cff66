#include "pdx/base/text_file.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/number.hpp"
#include "pdx/base/shown.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>
#include <unistd.h>

namespace pdx {
namespace {
constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text)
{
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  return text.substr(begin, text.find_last_not_of(kBlanks) + 1 - begin);
}

bool is_control(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F; }
} // namespace

std::string why_unreadable(const std::filesystem::path& path)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) return "there is no such file: check the path";
  if (error) return fmt::format("cannot be read ({}): check the path", error.message());
  if (fs::is_directory(status)) return "is a directory: give a file";
  if (!fs::is_regular_file(status)) return "is no regular file, but a pipe or a device: give a file";
  if (access(path.c_str(), R_OK) != 0) return fmt::format("cannot be read ({})", std::strerror(errno));
  return "";
}

TextFile::TextFile(const std::string& option, const std::filesystem::path& path)
    : name_(fmt::format("{}{}{}", option, option.empty() ? "" : " ", shown_path(path.string())))
{
  const std::string why = why_unreadable(path);
  if (!why.empty()) throw UserError(fmt::format("{}: {}", name_, why));
  file_.open(path, std::ios::binary);
  char head[3] = {};
  file_.read(head, 3);
  const std::string_view begin(head, static_cast<std::size_t>(file_.gcount()));
  if (begin.starts_with("\xFF\xFE") || begin.starts_with("\xFE\xFF"))
    throw UserError(fmt::format("{}: is UTF-16 text: save it as UTF-8", name_));
  file_.clear();
  file_.seekg(begin == "\xEF\xBB\xBF" ? 3 : 0);
}

bool TextFile::next()
try {
  using Traits = std::ifstream::traits_type;
  std::filebuf& buffer = *file_.rdbuf();
  line_.clear();
  if (Traits::eq_int_type(buffer.sgetc(), Traits::eof())) return false;
  ++number_;
  for (auto c = buffer.sbumpc(); !Traits::eq_int_type(c, Traits::eof()); c = buffer.sbumpc()) {
    const char byte = Traits::to_char_type(c);
    if (byte == '\r' && buffer.sgetc() == '\n') continue;
    if (byte == '\n' || byte == '\r') break;
    if (is_control(byte)) refuse(fmt::format("has the control character {}: this is no text", shown({&byte, 1})));
    if (line_.size() == kLongestLine) refuse(fmt::format("is longer than {} characters", kLongestLine));
    line_.push_back(byte);
  }
  return true;
} catch (const std::ios_base::failure&) {
  throw UserError(fmt::format("{}: cannot be read beyond line {} ({})", name_, number_, std::strerror(errno)));
}

std::string TextFile::where() const { return fmt::format("{}, line {}", name_, number_); }

void TextFile::refuse(std::string_view why) const { throw UserError(fmt::format("{}: {}", where(), why)); }

double TextFile::real(std::string_view word) const
{
  if (word.empty()) refuse("an item is empty: give one comma between two numbers");
  const auto value = real_in(word);
  if (!value) refuse(fmt::format("\"{}\" is not a number", shown(word)));
  if (!std::isfinite(*value)) refuse(fmt::format("\"{}\" is not a finite number", shown(word)));
  return *value;
}

int TextFile::whole(std::string_view word) const
{
  const auto value = whole_in(word);
  if (!value) refuse(fmt::format("\"{}\" is not a whole number", shown(word)));
  if (*value < std::numeric_limits<int>::min() || *value > std::numeric_limits<int>::max())
    refuse(fmt::format("{} must be within -2147483648 and 2147483647", shown(word)));
  return static_cast<int>(*value);
}

std::vector<std::string_view> words_of(std::string_view line)
{
  std::vector<std::string_view> words;
  line = trimmed(line.substr(0, line.find('#')));
  bool comma = false;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find_first_of(" \t,"), line.size());
    words.push_back(line.substr(0, end));
    line = trimmed(line.substr(end));
    comma = line.starts_with(',');
    if (comma) line = trimmed(line.substr(1));
  }
  if (comma) words.push_back({});
  return words;
}

std::vector<std::string_view> cells_of(std::string_view line)
{
  std::vector<std::string_view> cells;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    cells.push_back(trimmed(line.substr(from, comma - from)));
    from = comma + 1;
  }
  return cells;
}
} // namespace pdx
