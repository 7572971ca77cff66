#include "pdx/options/option_reader.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/base/text_file.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <utility>

namespace pdx::options {
namespace {
constexpr int kDeepest = 16, kMostFiles = 1000;           // files named in files; a circle is found by its depth
constexpr std::size_t kMostBytes = std::size_t{1} << 24u; // of all files
constexpr std::size_t kLongestName = 200;                 // characters; PETSc takes less than 512
constexpr std::array<std::string_view, 3> kYaml{"-options_file_yaml", "-options_string_yaml", "-options_yaml"};

[[noreturn]] void refuse(const std::string& place, const std::string& what)
{
  throw UserError(place.empty() ? what : fmt::format("{}: {}", place, what));
}

void refuse_controls(const OptionWord& word, const std::string& place)
{
  const auto control = std::ranges::find_if(
      word.text, [](char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7F; });
  if (control != word.text.end())
    refuse(place, fmt::format("\"{}\" has the control character {}", shown(word.text), shown({&*control, 1})));
}

/// A name with a sign of other formats behind it, or with a no-break space, which looks like a blank.
bool ends_oddly(const std::string& name)
{
  return std::string_view(":;,").find(name.back()) != std::string_view::npos ||
         name.find("\u00a0") != std::string::npos;
}

/// One value from its words: a list may have blanks after or before its commas.
std::string joined(const std::string& name, std::span<const OptionWord> values, const std::string& place)
{
  if (values.empty()) return "";
  std::string value = values[0].text;
  if (!values[0].quoted && value == "=") refuse(place, fmt::format("{} = ...: drop the sign =", shown(name)));
  for (const OptionWord& word : values.subspan(1)) {
    if (!value.ends_with(',') && !word.text.starts_with(','))
      refuse(place,
             fmt::format("\"{}\" is one word too many after {} {}: {}", shown(word.text), shown(name), shown(value),
                         name == "-options_file"
                             ? "each file has its own -options_file, a path with blanks stands in quotes"
                         : place.empty() ? "an option has one value, one with blanks stands in quotes"
                                         : "an option has one value, one with blanks stands in quotes, notes "
                                           "begin with #"));
    value += word.text;
  }
  return value;
}

bool is_yaml(const std::string& path)
{
  constexpr std::array<std::string_view, 4> ends{".yaml", ".yml", ".json", ":yaml"};
  return std::ranges::any_of(ends, [&](std::string_view end) { return path.ends_with(end); });
}
} // namespace

void OptionReader::read_resource_files(const std::filesystem::path& home)
{
  std::error_code none;
  for (const std::filesystem::path& path :
       {home / ".petscrc", std::filesystem::path("./.petscrc"), std::filesystem::path("petscrc")})
    if (path != ".petscrc" && std::filesystem::is_regular_file(path, none)) read_file(path.string(), "");
}

void OptionReader::read_environment(const std::string& variable, std::string_view text)
{
  try {
    read_words(split_option_words(text, false), variable);
  } catch (const UserError& error) {
    const std::string what = error.what();
    throw UserError(what.starts_with(variable) ? what : fmt::format("{}: {}", variable, what));
  }
}

void OptionReader::read_command_line(std::span<const std::string> words)
{
  std::vector<OptionWord> all;
  for (const std::string& word : words) all.push_back({word, false});
  read_words(all, "");
}

std::vector<GivenOption> OptionReader::take()
{
  if (!prefixes_.empty())
    refuse(prefixes_.back().place, fmt::format("-prefix_push {} has no -prefix_pop", shown(prefixes_.back().value)));
  return std::exchange(options_, {});
}

void OptionReader::read_file(const std::string& path, const std::string& place)
{
  const std::string named = fmt::format("-options_file {}", shown_path(path));
  if (path.empty()) refuse(place, "-options_file has no value: give a path");
  if (is_yaml(path)) refuse(place, named + ": YAML is not read: write -name value on each line");
  if (depth_ == kDeepest)
    refuse(place, fmt::format("{}: more than {} files named in files, or a circle", named, depth_));
  if (++files_ > kMostFiles) refuse(place, fmt::format("{}: more than {} options files", named, kMostFiles));
  if (const std::string why = why_unreadable(path); !why.empty()) refuse(place, fmt::format("{}: {}", named, why));
  ++depth_;
  std::error_code none;
  directories_.push_back(std::filesystem::absolute(path, none).parent_path());
  for (TextFile file("", path); file.next();) {
    bytes_ += file.line().size();
    if (bytes_ > kMostBytes) file.refuse(fmt::format("more than {} bytes of options", kMostBytes));
    read_line(file.line(), file.where());
  }
  directories_.pop_back();
  --depth_;
}

std::string OptionReader::found(const std::string& name, const std::string& value) const
{
  const std::filesystem::path path = value;
  std::error_code none;
  if (directories_.empty() || value.empty() || !(name == "-pd_cloud" || name.ends_with("_file")) ||
      path.is_absolute() || std::filesystem::exists(path, none))
    return value;
  for (std::filesystem::path above = directories_.back();; above = above.parent_path()) {
    if (std::filesystem::exists(above / path, none)) return (above / path).string();
    if (above == above.parent_path()) return value; // that which is said of it is said where it is read
  }
}

void OptionReader::read_line(std::string_view line, const std::string& place)
{
  std::vector<OptionWord> words;
  try {
    words = split_option_words(line, true);
  } catch (const UserError& error) {
    refuse(place, error.what());
  }
  if (words.empty()) return;
  if (!is_option_name(words[0]))
    refuse(place, fmt::format("\"{}\" is no option: a line is -name value, or # comment", shown(words[0].text)));
  const auto second = std::find_if(words.begin() + 1, words.end(), is_option_name);
  if (second != words.end())
    refuse(place, fmt::format("\"{}\" is a second option on the line of {}: give it a line of its own",
                              shown(second->text), shown(words[0].text)));
  read_words(words, place);
}

void OptionReader::read_words(Words words, const std::string& place)
{
  for (const OptionWord& word : words) refuse_controls(word, place);
  while (!words.empty()) {
    if (!is_option_name(words[0]))
      refuse(place, fmt::format("\"{}\"{} is no option: options are -name value", shown(words[0].text),
                                place.empty() ? " on the command line" : ""));
    const auto next = std::find_if(words.begin() + 1, words.end(), is_option_name);
    const auto count = static_cast<std::size_t>(next - words.begin());
    take_option(words[0].text, words.subspan(1, count - 1), place);
    words = words.subspan(count);
  }
}

/// -help may have words to look for, or -json behind it; -version has no value.
bool OptionReader::take_flag(const std::string& name, Words values, const std::string& place)
{
  const bool asks = name == "-help" || name == "--help" || name == "-h";
  const bool shows = name == "-version" || name == "--version" || name == "-v";
  if (help && name == "-json" && values.empty()) return json = true;
  if (!asks && !shows) return false;
  for (const OptionWord& word : values)
    if (asks) help_words += (help_words.empty() ? "" : " ") + word.text;
  if (!values.empty() && shows)
    refuse(place, fmt::format("\"{}\" is one word too many after {}", shown(values[0].text), name));
  help = help || asks;
  version = version || shows;
  return true;
}

void OptionReader::take_option(const std::string& name, Words values, const std::string& place)
{
  if (take_flag(name, values, place)) return;
  if (name.find('=') != std::string::npos)
    refuse(place, fmt::format("\"{}\": write a blank instead of =", shown(name)));
  if (ends_oddly(name))
    refuse(place, fmt::format("\"{}\" is no option: a plain blank belongs behind a name, and no sign", shown(name)));
  if (name.size() > kLongestName) refuse(place, fmt::format("\"{}\" is no option of pdxsolve", shown(name)));
  const std::string value = found(name, joined(name, values, place));
  if (std::ranges::find(kYaml, name) != kYaml.end())
    refuse(place, fmt::format("{}: YAML is not read: give -options_file with -name value on each line", name));
  if (name == "-options_file")
    read_file(value, place);
  else if (name == "-prefix_push" || name == "-prefix_pop")
    take_prefix(name, value, place);
  else if (name != "-skip_petscrc") { // looked for before anything was read
    std::string full = "-";
    for (const GivenOption& prefix : prefixes_) full += prefix.value;
    options_.push_back({full + name.substr(1), value, place});
  }
}

void OptionReader::take_prefix(const std::string& name, const std::string& value, const std::string& place)
{
  if (name == "-prefix_push") {
    if (value.empty()) refuse(place, "-prefix_push has no value: give the beginning of names, e.g. mg_levels_");
    prefixes_.push_back({name, value, place});
    return;
  }
  if (!value.empty()) refuse(place, fmt::format("\"{}\" is one word too many after -prefix_pop", shown(value)));
  if (prefixes_.empty()) refuse(place, "-prefix_pop has no -prefix_push before it");
  prefixes_.pop_back();
}
} // namespace pdx::options
