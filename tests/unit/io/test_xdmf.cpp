#include "pdx/io/xdmf.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace {
using namespace pdx::io;

/// True if every element that opens also closes, in order.
bool well_formed(const std::string& xml)
{
  std::vector<std::string> open;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.front() == '?' || tag.back() == '/') continue;
    if (tag.front() != '/')
      open.push_back(tag.substr(0, tag.find(' ')));
    else if (open.empty() || open.back() != tag.substr(1))
      return false;
    else
      open.pop_back();
  }
  return open.empty();
}

std::size_t count(const std::string& text, const std::string& word)
{
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++n;
  return n;
}

XdmfGrid mesh()
{
  return {"mesh",
          "/step000000/mesh",
          6,
          2,
          true,
          {{"displacement [m]", "displacement", 3, false, false},
           {"stress [Pa]", "stress", 6, true, false},
           {"use", "use", 1, true, true}}};
}
XdmfGrid particles(int n) { return {"particles", "/step000000/particles", n, n, false, {}}; }
} // namespace

TEST(Xdmf, DocumentIsWellFormed)
{
  const std::vector<XdmfGrid> grids{mesh(), particles(3)};
  const std::string xml = xdmf_document(xdmf_step("fields.h5", 0.1, grids) + xdmf_step("fields.h5", 0.2, grids));
  EXPECT_TRUE(well_formed(xml)) << xml;
  EXPECT_EQ(count(xml, "GridType=\"Uniform\""), 4u);
  EXPECT_EQ(count(xml, "CollectionType=\"Temporal\""), 1u);
  EXPECT_EQ(count(xml, "CollectionType=\"Spatial\""), 2u);
}

TEST(Xdmf, TimeKeepsAllDigits)
{
  const std::vector<XdmfGrid> grids{mesh()};
  EXPECT_NE(xdmf_step("fields.h5", 0.1, grids).find("Value=\"0.10000000000000001\""), std::string::npos);
}

TEST(Xdmf, ParticlesHaveAnExplicitTopology)
{
  const std::vector<XdmfGrid> grids{particles(3)};
  const std::string xml = xdmf_step("fields.h5", 0.0, grids);
  EXPECT_NE(xml.find("TopologyType=\"Polyvertex\" NodesPerElement=\"1\" NumberOfElements=\"3\""), std::string::npos);
  EXPECT_NE(xml.find("Dimensions=\"3 1\" NumberType=\"Int\" Precision=\"4\" Format=\"HDF\">"
                     "fields.h5:/step000000/particles/cells<"),
            std::string::npos);
}

TEST(Xdmf, FieldsCarryTypeCentreAndSize)
{
  const std::vector<XdmfGrid> grids{mesh()};
  const std::string xml = xdmf_step("fields.h5", 0.0, grids);
  EXPECT_NE(xml.find("Name=\"displacement [m]\" AttributeType=\"Vector\" Center=\"Node\"><DataItem Dimensions=\"6 3\""),
            std::string::npos);
  EXPECT_NE(xml.find("Name=\"stress [Pa]\" AttributeType=\"Tensor6\" Center=\"Cell\"><DataItem Dimensions=\"2 6\""),
            std::string::npos);
  EXPECT_NE(xml.find("Name=\"use\" AttributeType=\"Scalar\" Center=\"Cell\"><DataItem Dimensions=\"2 1\" "
                     "NumberType=\"Int\""),
            std::string::npos);
}

TEST(Xdmf, EmptyGridsAreLeftOut)
{
  const std::vector<XdmfGrid> some{mesh(), particles(0)}, none{particles(0)};
  EXPECT_EQ(count(xdmf_step("fields.h5", 0.0, some), "GridType=\"Uniform\""), 1u);
  EXPECT_EQ(xdmf_step("fields.h5", 0.0, none), "");
}

TEST(Xdmf, NamesAreEscaped)
{
  XdmfGrid grid = mesh();
  grid.attributes = {{"a<b & \"c\"", "a", 1, false, false}};
  const std::vector<XdmfGrid> grids{grid};
  EXPECT_NE(xdmf_step("fields.h5", 0.0, grids).find("Name=\"a&lt;b &amp; &quot;c&quot;\""), std::string::npos);
}
