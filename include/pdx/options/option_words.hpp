#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pdx::options {
/// A word of a line of options; what stood in quotes may hold blanks and is never the name of an option.
struct OptionWord {
  std::string text;
  bool quoted = false;
};

/// Words with blanks between; " or ' around what holds blanks; in a file a word that begins with # begins a comment.
/// Throws UserError for a quote without end, or with something behind it.
std::vector<OptionWord> split_option_words(std::string_view line, bool with_comments);

/// -name, but not a negative number.
bool is_option_name(const OptionWord& word);
} // namespace pdx::options
