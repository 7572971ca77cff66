#pragma once
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace pdx {
/// Why a path cannot be read as a file, "" if it can: missing, a directory, a pipe or device that may never end, or
/// forbidden.
std::string why_unreadable(const std::filesystem::path& path);

/// The lines of a text file as editors write it: ended by LF, CRLF or CR, perhaps with a UTF-8 mark at the beginning.
/// What is wrong is refused by a UserError that names option, file, line and word.
class TextFile {
public:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 24u; ///< bytes; nothing readable is longer

  /// @param option that named the file, for messages; "": the path says enough
  TextFile(const std::string& option, const std::filesystem::path& path);
  bool next(); ///< goes to the next line; false: there is none
  std::string_view line() const { return line_; }
  std::size_t number() const { return number_; } ///< of the line, from 1
  std::string where() const;                     ///< "-crack_file a.txt, line 3"
  [[noreturn]] void refuse(std::string_view why) const;
  double real(std::string_view word) const; ///< a finite number
  int whole(std::string_view word) const;   ///< a whole number, 1.0 too

private:
  std::string name_, line_;
  std::ifstream file_;
  std::size_t number_ = 0;
};

/// Words of a line of a table with blanks or a comma between; # begins a comment. A comma too many makes an empty word.
std::vector<std::string_view> words_of(std::string_view line);
/// What is between the commas of a line, without blanks around it.
std::vector<std::string_view> cells_of(std::string_view line);
} // namespace pdx
