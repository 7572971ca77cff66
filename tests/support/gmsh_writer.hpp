#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace mesh_files {
/// Two cells [0,1] x [0,1] and [1,2] x [0,1] as Gmsh numbers them: points, curves and surfaces begin at 1 each, and
/// physical groups too, in another order. Curve 1 is x = 0 in group 2 "left", curve 2 is x = 2 in group 1 "right",
/// curve 3 is y = 0 in groups 3 "bottom" and 2, curve 4 is y = 1 in no group; the surface is in two groups, the point
/// at the origin in 1 "corner". Node numbers have gaps and descend.
class EqualTags {
public:
  EqualTags(bool blocks, bool binary) : blocks_(blocks), binary_(binary) {}

  std::string write()
  {
    text_ = blocks_ ? "$MeshFormat\n4.1 " : "$MeshFormat\n2.2 ";
    text_ += binary_ ? "1 8\n" : "0 8\n";
    if (binary_) small(1), end_line();
    text_ += "$EndMeshFormat\n$PhysicalNames\n5\n0 1 \"corner\"\n1 1 \"right\"\n1 2 \"left\"\n1 3 \"bottom\"\n"
             "2 1 \"plate\"\n$EndPhysicalNames\n";
    blocks_ ? write_blocks() : write_list();
    return text_;
  }

private:
  struct Element {
    int type, group, entity;
    std::vector<int> nodes;
  };
  static constexpr int kNode[] = {600, 50, 40, 30, 20, 1}; // (0,0) (1,0) (2,0) (0,1) (1,1) (2,1)

  void small(std::int32_t value) { put(value); }
  void large(std::int64_t value) { put(value); }
  void real(double value) { put(value); }
  template <class Value> void put(Value value)
  {
    if (binary_)
      text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    else
      text_ += std::to_string(value) + " ";
  }
  void end_line() { text_ += "\n"; }
  void point(int k) { real(k % 3), real(k / 3), real(0.0); }

  void write_list()
  {
    text_ += "$Nodes\n6\n";
    for (int k = 0; k < 6; ++k) small(kNode[k]), point(k);
    text_ += "\n$EndNodes\n$Elements\n";
    const int a = kNode[0], b = kNode[1], c = kNode[2], d = kNode[3], e = kNode[4], f = kNode[5];
    const std::vector<Element> elements = {{15, 1, 1, {a}},         {1, 2, 1, {a, d}},       {1, 1, 2, {c, f}},
                                           {1, 3, 3, {a, b}},       {1, 3, 3, {b, c}},       {1, 2, 3, {a, b}},
                                           {1, 2, 3, {b, c}},       {1, 0, 4, {d, e}},       {1, 0, 4, {e, f}},
                                           {3, 1, 1, {a, b, e, d}}, {3, 1, 1, {b, c, f, e}}, {3, 2, 1, {a, b, e, d}},
                                           {3, 2, 1, {b, c, f, e}}};
    text_ += std::to_string(elements.size()) + "\n";
    int number = 0;
    for (const Element& element : elements) {
      if (!binary_) small(++number);
      small(element.type);
      if (binary_) small(1); // element of this kind
      small(2);              // tags
      if (binary_) small(++number);
      small(element.group), small(element.entity);
      for (const int node : element.nodes) small(node);
    }
    text_ += "\n$EndElements\n";
  }

  void entity(int tag, const std::vector<int>& groups, const std::vector<int>& borders)
  {
    small(tag);
    for (const double x : {0.0, 0.0, 0.0, 2.0, 1.0, 0.0}) real(x);
    large(static_cast<std::int64_t>(groups.size()));
    for (const int group : groups) small(group);
    large(static_cast<std::int64_t>(borders.size()));
    for (const int border : borders) small(border);
  }
  void block(int dimension, int entity, int type, const std::vector<std::vector<int>>& elements)
  {
    small(dimension), small(entity), small(type), large(static_cast<std::int64_t>(elements.size()));
    for (const auto& nodes : elements) {
      large(++elements_);
      for (const int node : nodes) large(node);
    }
  }

  void write_blocks()
  {
    text_ += "$Entities\n";
    large(1), large(4), large(1), large(0);
    small(1), point(0), large(1), small(1);
    entity(1, {2}, {1, -2}), entity(2, {1}, {1, 2}), entity(3, {3, -2}, {}), entity(4, {}, {}), entity(1, {1, 2}, {1});
    text_ += "\n$EndEntities\n$Nodes\n";
    large(2), large(6), large(1), large(600);
    small(1), small(1), small(1), large(2), large(kNode[0]), large(kNode[1]); // with a parameter on the curve
    point(0), real(0.25), point(1), real(0.5);
    small(2), small(1), small(0), large(4);
    for (int k = 2; k < 6; ++k) large(kNode[k]);
    for (int k = 2; k < 6; ++k) point(k);
    text_ += "\n$EndNodes\n$Elements\n";
    const int a = kNode[0], b = kNode[1], c = kNode[2], d = kNode[3], e = kNode[4], f = kNode[5];
    large(6), large(9), large(1), large(9);
    block(0, 1, 15, {{a}}), block(1, 1, 1, {{a, d}}), block(1, 2, 1, {{c, f}}), block(1, 3, 1, {{a, b}, {b, c}});
    block(1, 4, 1, {{d, e}, {e, f}}), block(2, 1, 3, {{a, b, e, d}, {b, c, f, e}});
    text_ += "\n$EndElements\n";
  }

  bool blocks_, binary_;
  std::string text_;
  int elements_ = 0;
};
} // namespace mesh_files
