#include "pdx/io/xdmf.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::io {
namespace {
constexpr std::string_view kStep = "<Grid Name=\"step\" GridType=\"Collection\" CollectionType=\"Spatial\">\n";
constexpr std::string_view kEnd = "</Grid>\n</Domain>\n</Xdmf>\n";

std::string escaped(std::string_view text)
{
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

struct Item {
  std::int64_t rows;
  int columns;
  bool integer;
};

std::string data_item(const Item& item, std::string_view data_file, const std::string& path)
{
  return fmt::format(R"(<DataItem Dimensions="{} {}" NumberType="{}" Precision="{}" Format="HDF">{}:{}</DataItem>)",
                     item.rows, item.columns, item.integer ? "Int" : "Float", item.integer ? 4 : 8, data_file,
                     escaped(path));
}

const char* attribute_type(int components)
{
  return components == 1 ? "Scalar" : components == 3 ? "Vector" : "Tensor6";
}

std::string topology(const XdmfGrid& grid, std::string_view data_file)
{
  const int nodes = grid.quadrilaterals ? 4 : 1;
  return fmt::format("<Topology TopologyType=\"{}\" NodesPerElement=\"{}\" NumberOfElements=\"{}\">{}</Topology>\n",
                     grid.quadrilaterals ? "Quadrilateral" : "Polyvertex", nodes, grid.cells,
                     data_item({grid.cells, nodes, true}, data_file, grid.group + "/cells"));
}

std::string attribute(const XdmfGrid& grid, const XdmfAttribute& field, std::string_view data_file)
{
  const std::int64_t rows = field.on_cells ? grid.cells : grid.points;
  return fmt::format("<Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"{}\">{}</Attribute>\n", escaped(field.name),
                     attribute_type(field.components), field.on_cells ? "Cell" : "Node",
                     data_item({rows, field.components, field.integer}, data_file, grid.group + "/" + field.dataset));
}

std::string uniform_grid(const XdmfGrid& grid, std::string_view data_file)
{
  std::string out = fmt::format("<Grid Name=\"{}\" GridType=\"Uniform\">\n", escaped(grid.name));
  out += topology(grid, data_file);
  out += fmt::format("<Geometry GeometryType=\"XYZ\">{}</Geometry>\n",
                     data_item({grid.points, 3, false}, data_file, grid.group + "/points"));
  for (const XdmfAttribute& field : grid.attributes) out += attribute(grid, field, data_file);
  return out + "</Grid>\n";
}
} // namespace

std::string xdmf_step(std::string_view data_file, double time, std::span<const XdmfGrid> grids)
{
  std::string inner;
  for (const XdmfGrid& grid : grids)
    if (grid.points > 0 && grid.cells > 0) inner += uniform_grid(grid, data_file);
  if (inner.empty()) return "";
  return fmt::format("{}<Time Value=\"{:.17g}\"/>\n{}</Grid>\n", kStep, time, inner);
}

std::string xdmf_first_steps(std::string_view document, int steps)
{
  const std::size_t begin = document.find(kStep), last = document.rfind(kEnd);
  if (begin == std::string_view::npos || last == std::string_view::npos || steps == 0) return "";
  std::size_t end = begin;
  for (int k = 0; k < steps && end < last; ++k) end = std::min(document.find(kStep, end + 1), last);
  return std::string(document.substr(begin, end - begin));
}

std::string xdmf_document(std::string_view steps)
{
  return fmt::format("<?xml version=\"1.0\" ?>\n<Xdmf Version=\"3.0\">\n<Domain>\n"
                     "<Grid Name=\"run\" GridType=\"Collection\" CollectionType=\"Temporal\">\n{}{}",
                     steps, kEnd);
}
} // namespace pdx::io
