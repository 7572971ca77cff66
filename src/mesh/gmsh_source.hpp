#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace pdx::mesh {
/// The bytes of a Gmsh file, read from front to back. Nothing is read beyond the end, and no count is believed that the
/// rest of the file cannot hold. Knows where it is: every refusal names the line, or the byte of a binary section.
class GmshSource {
public:
  /// Reads a regular file; skips a UTF-8 mark. Throws UserError.
  explicit GmshSource(std::string file, std::string option = "-mesh_file");

  std::string name() const; ///< "-mesh_file FILE", or another option
  [[noreturn]] void refuse(const std::string& what) const;
  [[noreturn]] void refuse_at(std::size_t place, const std::string& what) const; ///< @param place of `here`
  std::size_t here() const { return last_; }                                     ///< place of what was read last

  bool binary() const { return binary_; }
  /// From now on `small`, `large` and `real` read binary values.
  void set_binary() { binary_ = true; }

  std::string_view word(); ///< next word, "" at the end
  std::string_view line(); ///< the rest of the line
  void end_line();         ///< goes behind the end of the line, where binary values begin
  void expect(std::string_view title);
  /// Goes behind the line $End... of a section; `sections` are those whose beginning says that it was not closed.
  void skip_section(std::string_view title, std::span<const std::string_view> sections);

  std::int64_t text_number(); ///< a whole number in words, also of a binary file
  std::int64_t small();       ///< a whole number of 4 bytes
  std::int64_t large();       ///< a whole number of 8 bytes
  double real();              ///< finite
  /// A number of things that have at least so many values each.
  std::size_t count(std::int64_t value, std::size_t values) const;
  void skip(std::size_t reals);

private:
  template <class Value> Value raw();
  void skip_blanks();
  std::string where(std::size_t place) const;

  std::string option_, file_, bytes_;
  std::size_t here_ = 0, last_ = 0;
  bool binary_ = false;
};

/// A word as it may stand in a message: short, control characters and what is no ASCII as escapes.
std::string shown(std::string_view word);
} // namespace pdx::mesh
