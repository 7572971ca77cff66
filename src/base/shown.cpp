#include "pdx/base/shown.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx {
namespace {
/// One character of UTF-8 at the beginning of a text: its number and bytes; one byte and no number where it is none.
struct Character {
  char32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

Character first_of(std::string_view text)
{
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {lead, 1, true};
  const std::size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
  char32_t code = lead & (0x7Fu >> bytes);
  for (std::size_t k = 1; k < bytes; ++k) {
    if ((byte(k) & 0xC0u) != 0x80u) return {};
    code = code << 6u | (byte(k) & 0x3Fu);
  }
  static constexpr char32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool valid = code >= least[bytes] && code <= 0x10FFFF && (code < 0xD800 || code > 0xDFFF);
  return valid ? Character{code, bytes, true} : Character{};
}

/// Cannot be seen, or looks like another one: blanks, marks of direction, typeset dashes and quotes, minus.
bool deceives(char32_t c)
{
  return c < 0x20 || (c >= 0x7F && c <= 0xA0) || c == 0xAD || (c >= 0x2000 && c <= 0x206F) || c == 0x2212 ||
         c == 0x3000 || (c >= 0xFE00 && c <= 0xFE0F) || c == 0xFEFF || (c >= 0xE000 && c <= 0xF8FF) || c >= 0xE0000;
}

std::string escaped(std::string_view text, const Character& c)
{
  if (c.valid && !deceives(c.code)) return std::string(text.substr(0, c.bytes));
  if (!c.valid || c.code < 0x80) return fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
  return fmt::format("\\u{{{:04x}}}", static_cast<std::uint32_t>(c.code));
}

std::string escaped(std::string_view text)
{
  std::string line;
  while (!text.empty()) {
    const Character c = first_of(text);
    line += escaped(text, c);
    text.remove_prefix(c.bytes);
  }
  return line;
}

/// The nearest place at or before `at` where a character begins.
std::size_t whole_before(std::string_view text, std::size_t at)
{
  while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0u) == 0x80u) --at;
  return at;
}
} // namespace

std::string shown(std::string_view text, std::size_t most)
{
  std::string line;
  std::size_t count = 0;
  while (!text.empty()) {
    const Character c = first_of(text);
    const std::string next = escaped(text, c);
    count += c.valid && next.size() == c.bytes ? 1 : next.size();
    if (count > most) return line + "...";
    line += next;
    text.remove_prefix(c.bytes);
  }
  return line;
}

std::string shown_path(std::string_view path)
{
  constexpr std::size_t most = 120;
  const std::string line = escaped(path.substr(path.size() - std::min(path.size(), 4 * most)));
  if (line.size() <= most) return line;
  return "..." + line.substr(whole_before(line, line.size() - most));
}

std::string as_one_line(std::string_view message)
{
  constexpr std::size_t most = 640, head = 400, word = 30;
  const std::string line = escaped(message);
  if (line.size() <= most) return line;
  std::size_t end = whole_before(line, head), begin = whole_before(line, line.size() - (most - head - 5));
  if (const std::size_t blank = line.rfind(' ', end); blank != std::string::npos && end - blank <= word) end = blank;
  if (const std::size_t blank = line.find(' ', begin); blank != std::string::npos && blank - begin <= word)
    begin = blank + 1; // neither half of a word nor of a number
  return line.substr(0, end) + " ... " + line.substr(begin);
}
} // namespace pdx
