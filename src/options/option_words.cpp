#include "pdx/options/option_words.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/number.hpp"
#include "pdx/base/shown.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace pdx::options {
namespace {
constexpr std::string_view kBlanks = " \t\r\n";

/// Takes a quoted word off the beginning of a line.
OptionWord take_quoted(std::string_view& line)
{
  const std::size_t end = line.find(line[0], 1);
  if (end == std::string_view::npos) throw UserError(fmt::format("{} begins a quote that does not end", shown(line)));
  OptionWord word{std::string(line.substr(1, end - 1)), true};
  line.remove_prefix(end + 1);
  if (!line.empty() && kBlanks.find(line[0]) == std::string_view::npos)
    throw UserError(fmt::format("\"{}\" follows a quote without a blank between", shown(line)));
  return word;
}

OptionWord take_plain(std::string_view& line)
{
  const std::size_t end = std::min(line.find_first_of(kBlanks), line.size());
  OptionWord word{std::string(line.substr(0, end)), false};
  line.remove_prefix(end);
  return word;
}
} // namespace

std::vector<OptionWord> split_option_words(std::string_view line, bool with_comments)
{
  std::vector<OptionWord> words;
  for (;;) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    if (line.empty() || (with_comments && line[0] == '#')) return words;
    words.push_back(line[0] == '"' || line[0] == '\'' ? take_quoted(line) : take_plain(line));
    if (const OptionWord& word = words.back(); with_comments && !word.quoted && word.text.find('#') < word.text.size())
      throw UserError(fmt::format("\"{}\": put a blank before # where a comment begins, or quotes around a value",
                                  shown(word.text)));
  }
}

bool is_option_name(const OptionWord& word)
{
  const std::string& text = word.text;
  if (word.quoted || text.size() < 2 || text[0] != '-') return false;
  const char first = text[1] == '-' && text.size() > 2 ? text[2] : text[1];
  return std::isalpha(static_cast<unsigned char>(first)) && !real_in(text);
}
} // namespace pdx::options
