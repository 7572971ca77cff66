#include "gmsh_scan.hpp"

#include "pdx/base/error.hpp"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <set>

namespace pdx::mesh {
namespace {
constexpr std::string_view kSections[] = {"$MeshFormat", "$PhysicalNames",       "$Entities",
                                          "$Nodes",      "$PartitionedEntities", "$Elements"};

/// Elements of a Gmsh type, as far as they may stand in a mesh of four-node cells.
struct Kind {
  std::size_t nodes;
  int dimension;
};

Kind kind_of(const GmshSource& source, std::int64_t type, GmshCells cells)
{
  constexpr std::int64_t kLines[] = {1, 8, 26, 27, 28}; // of 2, 3 ... nodes, the ends first
  constexpr std::int64_t kTriangle = 2, kQuadrilateral = 3, kPoint = 15;
  constexpr std::int64_t kHigherOrder[] = {9, 10, 16, 20, 21, 22, 23, 24, 25, 36, 37, 38, 39, 40, 41};
  if (type == kPoint) return {1, 0};
  if (type == kQuadrilateral) return {4, 2};
  if (const auto* line = std::find(std::begin(kLines), std::end(kLines), type); line != std::end(kLines))
    return {2 + static_cast<std::size_t>(line - kLines), 1};
  if (type == kTriangle && cells == GmshCells::any) return {3, 2};
  if (type == kTriangle) source.refuse("has triangles; only four-node cells are known: recombine the surface in Gmsh");
  if (std::find(std::begin(kHigherOrder), std::end(kHigherOrder), type) != std::end(kHigherOrder))
    source.refuse("has elements of higher order; only four-node cells are known: set Mesh.ElementOrder = 1 in Gmsh");
  source.refuse(fmt::format("has elements of Gmsh type {}; only four-node cells in a plane are known: save the "
                            "two-dimensional mesh alone, recombined into quadrilaterals",
                            type));
}

class Scan {
public:
  Scan(GmshSource& source, GmshCells cells) : source_(source), cells_(cells) {}

  GmshFile read()
  {
    for (std::string_view title = source_.word(); !title.empty(); title = source_.word()) read_section(title);
    for (const std::string_view needed : {"$MeshFormat", "$Nodes", "$Elements"})
      if (!seen_.contains(needed))
        source_.refuse(needed == "$MeshFormat" ? "this is no Gmsh file: give one of format 2.2 or 4.1"
                                               : fmt::format("there is no {} section: write the file again", needed));
    if (blocks_) {
      name_lines();
      name_cells();
    }
    return std::move(file_);
  }

private:
  using Entity = std::pair<std::int64_t, std::int64_t>; // dimension, tag
  struct LineOfEntity {
    std::array<std::size_t, 2> ends;
    std::int64_t entity;
    std::size_t place;
  };

  void read_section(std::string_view title)
  {
    const bool format = title == "$MeshFormat";
    const auto* known = std::find(std::begin(kSections), std::end(kSections), title);
    if (seen_.empty() && !format && title != "$Comments")
      source_.refuse("this is no Gmsh file: give one of format 2.2 or 4.1");
    if (!title.starts_with('$'))
      source_.refuse(fmt::format("\"{}\" outside of all sections: write the file again", shown(title)));
    const bool old_entities = !blocks_ && (title == "$Entities" || title == "$PartitionedEntities");
    if (known == std::end(kSections) || old_entities)
      return source_.skip_section(title, title == "$Comments" ? std::span<const std::string_view>() : kSections);
    if (!seen_.insert(*known).second) source_.refuse(fmt::format("{} is there twice: write the file again", title));
    if (format) read_format();
    if (title == "$PhysicalNames") read_names();
    if (title == "$Entities") read_entities(false);
    if (title == "$PartitionedEntities") read_entities(true);
    if (title == "$Nodes") read_nodes();
    if (title == "$Elements") read_elements();
    source_.expect(fmt::format("$End{}", known->substr(1)));
  }

  void read_format()
  {
    const std::string_view version = source_.word();
    if (version != "2.2" && version != "4.1")
      source_.refuse(
          fmt::format("format {} is not known: save as 2.2 or 4.1 (gmsh -format msh41)", shown(version.substr(0, 10))));
    blocks_ = version == "4.1";
    const std::int64_t binary = source_.text_number();
    if (binary != 0 && binary != 1)
      source_.refuse(fmt::format("{} where 0 (text) or 1 (binary) belongs: write the file again", binary));
    const std::int64_t size = source_.text_number();
    if (size != 8 && (binary || size != 4))
      source_.refuse(fmt::format("numbers of {} bytes are not known, only those of 8: write the file again", size));
    if (!binary) return;
    source_.end_line();
    source_.set_binary();
    const std::int64_t one = source_.small();
    if (one == 0x01000000) source_.refuse("binary, of the other byte order: save it as text (gmsh -format msh41)");
    if (one != 1) source_.refuse("binary, but its byte order cannot be told: write the file again");
  }

  void read_names()
  {
    std::set<Entity> named;
    for (std::size_t left = source_.count(source_.text_number(), 3); left > 0; --left) {
      const std::int64_t dimension = source_.text_number(), tag = source_.text_number();
      const std::string_view quoted = source_.line();
      if (dimension < 0 || dimension > 3)
        source_.refuse(fmt::format("a physical group of dimension {}: write the file again", dimension));
      if (quoted.size() < 3 || quoted.front() != '"' || quoted.back() != '"')
        source_.refuse(fmt::format("{} where a name in quotes belongs: write the file again", shown(quoted)));
      const std::string_view name = quoted.substr(1, quoted.size() - 2);
      const auto control = [](char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; };
      if (name.size() > 127 || std::any_of(name.begin(), name.end(), control))
        source_.refuse(fmt::format("the name \"{}\" is too long or has control characters: choose another, of at most "
                                   "127 characters",
                                   shown(name)));
      if (!named.insert({dimension, tag}).second)
        source_.refuse(
            fmt::format("physical group {} of dimension {} is named twice: write the file again", tag, dimension));
      if (dimension == 1 && name == "unnamed")
        source_.refuse("a physical curve is called \"unnamed\", as are all edges without a name: choose another name");
      if (dimension == 1) file_.curve_names[tag] = name;
      if (dimension == 2) file_.surface_names[tag] = name;
    }
  }

  /// Physical groups of the entities. Those of a partition have their own and their parent's.
  void read_entities(bool partitioned)
  {
    if (binary()) source_.end_line();
    if (partitioned) {
      (void)source_.large(); // partitions
      for (std::size_t left = source_.count(source_.large(), 2); left > 0; --left)
        (void)source_.small(), (void)source_.small();
    }
    std::array<std::size_t, 4> counts{};
    for (std::size_t& count : counts) count = source_.count(source_.large(), 2);
    for (std::size_t d = 0; d < counts.size(); ++d)
      for (std::size_t k = 0; k < counts[d]; ++k) read_entity(static_cast<std::int64_t>(d), partitioned);
  }

  void read_entity(std::int64_t dimension, bool partitioned)
  {
    const Entity entity{dimension, source_.small()};
    std::set<std::int64_t> groups;
    if (partitioned) {
      const std::int64_t parent_dimension = source_.small();
      const Entity parent{parent_dimension, source_.small()};
      if (parent_dimension == dimension && groups_.contains(parent)) groups = groups_[parent];
      for (std::size_t left = source_.count(source_.large(), 1); left > 0; --left) (void)source_.small();
    }
    source_.skip(dimension == 0 ? 3 : 6); // a point, or a box
    for (std::size_t left = source_.count(source_.large(), 1); left > 0; --left)
      groups.insert(std::abs(source_.small()));
    if (dimension > 0)
      for (std::size_t left = source_.count(source_.large(), 1); left > 0; --left) (void)source_.small();
    const auto [place, fresh] = groups_.try_emplace(entity, std::move(groups));
    if (!fresh) refuse_entity(entity, "is there twice");
  }

  [[noreturn]] void refuse_entity(const Entity& entity, const char* what) const
  {
    source_.refuse(
        fmt::format("entity {} of dimension {} {}: write the file again", entity.second, entity.first, what));
  }

  bool binary() const { return source_.binary(); }
  std::int64_t tag() { return blocks_ ? source_.large() : source_.small(); }

  void read_node(std::int64_t tag)
  {
    if (tag < 1) source_.refuse(fmt::format("a node has the number {}: write the file again", tag));
    file_.nodes.push_back({tag, Vector<3>::Zero()});
  }
  void read_point(GmshFile::Node& node)
  {
    for (double& x : node.x) x = source_.real();
  }

  void read_nodes()
  {
    if (blocks_)
      read_node_blocks();
    else {
      const std::int64_t given = source_.text_number();
      if (binary()) source_.end_line();
      for (std::size_t left = source_.count(given, 4); left > 0; --left) {
        read_node(source_.small());
        read_point(file_.nodes.back());
      }
    }
    const auto by_tag = [](const GmshFile::Node& a, const GmshFile::Node& b) { return a.tag < b.tag; };
    if (!std::is_sorted(file_.nodes.begin(), file_.nodes.end(), by_tag))
      std::sort(file_.nodes.begin(), file_.nodes.end(), by_tag);
    for (std::size_t k = 1; k < file_.nodes.size(); ++k)
      if (file_.nodes[k - 1].tag == file_.nodes[k].tag)
        source_.refuse(fmt::format("$Nodes has node {} twice: write the file again", file_.nodes[k].tag));
  }

  void read_node_blocks()
  {
    if (binary()) source_.end_line();
    const std::size_t blocks = source_.count(source_.large(), 4);
    const std::size_t total = source_.count(source_.large(), 4);
    (void)source_.large(), (void)source_.large(); // lowest, highest tag
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::int64_t dimension = read_dimension();
      (void)source_.small(); // entity
      const std::int64_t parametric = source_.small();
      if (parametric != 0 && parametric != 1)
        source_.refuse(fmt::format("{} where 0 or 1 (parametric) belongs: write the file again", parametric));
      const std::size_t count = source_.count(source_.large(), 4), first = file_.nodes.size();
      for (std::size_t k = 0; k < count; ++k) read_node(source_.large());
      for (std::size_t k = 0; k < count; ++k) {
        read_point(file_.nodes[first + k]);
        if (parametric) source_.skip(static_cast<std::size_t>(dimension));
      }
    }
    require_total(total, file_.nodes.size(), "nodes");
  }

  std::int64_t read_dimension()
  {
    const std::int64_t dimension = source_.small();
    if (dimension < 0 || dimension > 3)
      source_.refuse(fmt::format("an entity of dimension {}: write the file again", dimension));
    return dimension;
  }

  void require_total(std::size_t told, std::size_t found, const char* what) const
  {
    if (told != found)
      source_.refuse(fmt::format("{} {} are announced, {} are there: write the file again", told, what, found));
  }

  void read_elements()
  {
    if (!seen_.contains("$Nodes")) source_.refuse("$Elements comes before $Nodes: write the file again");
    if (blocks_) return read_element_blocks();
    const std::int64_t given = source_.text_number();
    if (binary()) source_.end_line();
    const std::size_t total = source_.count(given, 3);
    for (std::size_t read = 0; read < total;) {
      if (!binary()) (void)source_.small(); // number of the element
      const Kind kind = kind_of(source_, source_.small(), cells_);
      const std::size_t alike = binary() ? source_.count(source_.small(), kind.nodes + 1) : 1;
      const std::size_t tags = source_.count(source_.small(), 1);
      if (alike == 0 || alike > total - read) source_.refuse("a block of elements is longer than all: write it again");
      for (std::size_t e = 0; e < alike; ++e, ++read) read_element(kind, tags);
    }
  }

  /// In 2.2: physical tag, elementary tag, then partitions.
  void read_element(Kind kind, std::size_t tags)
  {
    if (binary()) (void)source_.small(); // number of the element
    const std::size_t place = source_.here();
    std::array<std::int64_t, 2> first{0, 0};
    for (std::size_t k = 0; k < tags; ++k) {
      const std::int64_t tag = source_.small();
      if (k < 2) first[k] = std::abs(tag);
    }
    const std::array<std::size_t, 4> nodes = read_corners(kind);
    if (kind.dimension == 2) file_.cells.push_back({nodes, place, first[1], first[0]});
    if (kind.dimension == 1 && first[0]) file_.lines.push_back({{nodes[0], nodes[1]}, first[0]});
  }

  /// All nodes must be known; the first four are kept.
  std::array<std::size_t, 4> read_corners(Kind kind)
  {
    std::array<std::size_t, 4> corners{};
    for (std::size_t k = 0; k < kind.nodes; ++k) {
      const std::int64_t wanted = tag();
      const auto found = std::lower_bound(file_.nodes.begin(), file_.nodes.end(), wanted,
                                          [](const GmshFile::Node& node, std::int64_t t) { return node.tag < t; });
      if (found == file_.nodes.end() || found->tag != wanted)
        source_.refuse(fmt::format("an element has node {}, which is not in $Nodes: write the file again", wanted));
      if (k < corners.size()) corners[k] = static_cast<std::size_t>(found - file_.nodes.begin());
    }
    if (kind.nodes == 3) corners[3] = corners[2];
    return corners;
  }

  void read_element_blocks()
  {
    if (binary()) source_.end_line();
    const std::size_t blocks = source_.count(source_.large(), 4);
    const std::size_t total = source_.count(source_.large(), 2);
    (void)source_.large(), (void)source_.large(); // lowest, highest tag
    std::size_t read = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::int64_t dimension = read_dimension();
      const std::int64_t entity = source_.small();
      const Kind kind = kind_of(source_, source_.small(), cells_);
      if (kind.dimension != dimension)
        source_.refuse(fmt::format("elements of dimension {} in an entity of dimension {}: write the file again",
                                   kind.dimension, dimension));
      const std::size_t count = source_.count(source_.large(), kind.nodes + 1);
      for (std::size_t e = 0; e < count; ++e, ++read) {
        (void)source_.large(); // number of the element
        const std::size_t place = source_.here();
        const std::array<std::size_t, 4> nodes = read_corners(kind);
        if (dimension == 2) file_.cells.push_back({nodes, place, entity, 0});
        if (dimension == 1) lines_.push_back({{nodes[0], nodes[1]}, entity, place});
      }
    }
    require_total(total, read, "elements");
  }

  /// In 4.1 only entities know their physical groups.
  void name_lines()
  {
    if (!seen_.contains("$Entities") && !file_.curve_names.empty())
      source_.refuse("there is no $Entities section, which says where the named curves are: write the file again");
    for (const LineOfEntity& line : lines_) {
      const auto groups = groups_.find({1, line.entity});
      if (groups == groups_.end()) {
        if (!seen_.contains("$Entities")) continue;
        source_.refuse_at(line.place, fmt::format("the element is in curve {}, which is not in $Entities: write the "
                                                  "file again",
                                                  line.entity));
      }
      for (const std::int64_t group : groups->second) file_.lines.push_back({line.ends, group});
    }
  }

  void name_cells()
  {
    for (const auto& [entity, groups] : groups_)
      if (entity.first == 2) file_.surface_groups[entity.second] = groups;
  }

  GmshSource& source_;
  GmshCells cells_;
  GmshFile file_;
  bool blocks_ = false;                             // 4.1
  std::set<std::string_view> seen_;                 // of kSections
  std::map<Entity, std::set<std::int64_t>> groups_; // physical tags
  std::vector<LineOfEntity> lines_;                 // 4.1
};
} // namespace

GmshFile scan_gmsh(GmshSource& source, GmshCells cells) { return Scan(source, cells).read(); }
} // namespace pdx::mesh
