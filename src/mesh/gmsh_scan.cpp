#include "pdx/base/error.hpp"
#include "pdx/mesh/gmsh.hpp"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <string_view>

namespace pdx::mesh {
namespace {
/// Words of the file, one after the other; knows the line it is in.
class Words {
public:
  Words(const std::string& file, std::string_view text) : file_(file), text_(text) {}

  [[noreturn]] void refuse(const std::string& what) const
  {
    throw UserError(fmt::format("-mesh_file {}: line {}: {}", file_, line_, what));
  }
  std::string_view next()
  {
    skip_blanks();
    const std::size_t begin = here_;
    while (here_ < text_.size() && !blank(text_[here_])) ++here_;
    return text_.substr(begin, here_ - begin);
  }
  long number()
  {
    const std::string_view word = next();
    long value = 0;
    const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty()) refuse("the file ends too early: write it again");
    if (result.ec != std::errc{} || result.ptr != word.data() + word.size())
      refuse(fmt::format("\"{}\" where a whole number belongs: write the file again", word.substr(0, 40)));
    return value;
  }
  /// A number of things that need at least one character each.
  std::size_t count()
  {
    const long value = number();
    if (value < 0 || static_cast<std::size_t>(value) > text_.size())
      refuse(fmt::format("a count of {} cannot be right: write the file again", value));
    return static_cast<std::size_t>(value);
  }
  void skip(std::size_t words)
  {
    for (std::size_t k = 0; k < words; ++k)
      if (next().empty()) refuse("the file ends too early: write it again");
  }
  void skip_coordinates(std::size_t count)
  {
    for (std::size_t k = 0; k < count; ++k) {
      const std::string_view word = next();
      double value = 0.0;
      const auto result = std::from_chars(word.data() + word.starts_with('+'), word.data() + word.size(), value);
      if (result.ec != std::errc{} || result.ptr != word.data() + word.size())
        refuse(fmt::format("\"{}\" where a coordinate belongs: write the file again", word.substr(0, 40)));
    }
  }
  void expect(std::string_view title)
  {
    if (const std::string_view word = next(); word != title)
      refuse(fmt::format("\"{}\" where {} belongs: write the file again", word.substr(0, 40), title));
  }
  /// Goes behind the next line that is `title`; false if there is none.
  bool find(std::string_view title)
  {
    for (std::string_view word = next(); !word.empty(); word = next())
      if (word == title) return true;
    return false;
  }

private:
  static bool blank(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  void skip_blanks()
  {
    for (; here_ < text_.size() && blank(text_[here_]); ++here_) line_ += text_[here_] == '\n';
  }
  std::string file_;
  std::string_view text_;
  std::size_t here_ = 0, line_ = 1;
};

/// Nodes of an element of a Gmsh type; refuses types that make no mesh of four-node cells.
std::size_t node_count(const Words& words, long type)
{
  constexpr long kLine = 1, kTriangle = 2, kQuadrilateral = 3, kPoint = 15;
  constexpr long kSecondOrder[] = {8, 9, 10, 16, 20, 21, 26, 36};
  if (type == kPoint) return 1;
  if (type == kLine) return 2;
  if (type == kQuadrilateral) return 4;
  if (type == kTriangle) words.refuse("has triangles; only four-node cells are known: recombine the surface in Gmsh");
  if (std::find(std::begin(kSecondOrder), std::end(kSecondOrder), type) != std::end(kSecondOrder))
    words.refuse("has elements of higher order; only four-node cells are known: set Mesh.ElementOrder = 1 in Gmsh");
  words.refuse(fmt::format("has elements of Gmsh type {}; only four-node cells in a plane are known: save the "
                           "two-dimensional mesh alone, recombined into quadrilaterals",
                           type));
}

/// Node numbers of the file, ascending.
std::vector<long> scan_nodes(Words& words, bool blocks)
{
  if (!words.find("$Nodes")) words.refuse("there is no $Nodes section: write the file again");
  std::vector<long> tags;
  if (!blocks) {
    for (std::size_t left = words.count(); left > 0; --left) {
      tags.push_back(words.number());
      words.skip_coordinates(3);
    }
  } else {
    const std::size_t count = words.count();
    words.skip(3); // number of nodes, lowest, highest tag
    for (std::size_t block = 0; block < count; ++block) {
      const std::size_t dimension = words.count();
      words.skip(1); // entity
      const bool parametric = words.number() != 0;
      const std::size_t nodes = words.count();
      for (std::size_t k = 0; k < nodes; ++k) tags.push_back(words.number());
      words.skip_coordinates(nodes * (3 + (parametric ? dimension : 0)));
    }
  }
  words.expect("$EndNodes");
  std::sort(tags.begin(), tags.end());
  return tags;
}

void scan_nodes_of_element(Words& words, std::size_t nodes, const std::vector<long>& known)
{
  for (std::size_t k = 0; k < nodes; ++k) {
    const long tag = words.number();
    if (!std::binary_search(known.begin(), known.end(), tag))
      words.refuse(fmt::format("an element has node {}, which is not in $Nodes: write the file again", tag));
  }
}

void scan_elements(Words& words, bool blocks, const std::vector<long>& known)
{
  if (!words.find("$Elements")) words.refuse("there is no $Elements section: write the file again");
  const std::size_t count = words.count();
  if (blocks) words.skip(3); // number of elements, lowest, highest tag
  for (std::size_t k = 0; k < count; ++k) {
    words.skip(blocks ? 2 : 1); // entity, or number of the element
    const std::size_t nodes = node_count(words, words.number());
    const std::size_t elements = blocks ? words.count() : 1;
    if (!blocks) words.skip(words.count()); // tags
    for (std::size_t e = 0; e < elements; ++e) {
      if (blocks) words.skip(1); // number of the element
      scan_nodes_of_element(words, nodes, known);
    }
  }
  words.expect("$EndElements");
}

std::string whole_text(const std::string& file)
{
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    throw UserError(fmt::format("-mesh_file {}: there is no such file: check the path", file));
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  if (!stream) throw UserError(fmt::format("-mesh_file {}: the file cannot be read: check its permissions", file));
  return std::move(text).str();
}
} // namespace

void scan_gmsh(const std::string& file)
{
  const std::string text = whole_text(file);
  Words words(file, text);
  if (words.next() != "$MeshFormat") words.refuse("this is no Gmsh file: give one of format 2.2 or 4.1");
  const std::string_view version = words.next();
  if (version != "2.2" && version != "4.1")
    words.refuse(fmt::format("format {} is not known: save as 2.2 or 4.1 (gmsh -format msh41)", version.substr(0, 10)));
  const bool binary = words.number() != 0;
  if (binary) return;
  const bool blocks = version == "4.1";
  const std::vector<long> nodes = scan_nodes(words, blocks);
  scan_elements(words, blocks, nodes);
}
} // namespace pdx::mesh
