#include "pdx/base/given_options.hpp"
#include "pdx/mesh/build.hpp"

#include <gtest/gtest.h>

using namespace pdx::mesh;

namespace {
/// Options for the time of one test.
class Given {
public:
  explicit Given(std::vector<std::pair<std::string, std::string>> options) : options_(std::move(options))
  {
    for (const auto& [name, value] : options_) pdx::give_option({name, value, ""});
  }
  ~Given()
  {
    for (const auto& option : options_) pdx::take_back_option(option.first);
  }
  Given(const Given&) = delete;
  Given& operator=(const Given&) = delete;

private:
  std::vector<std::pair<std::string, std::string>> options_;
};

std::string refusal()
{
  try {
    (void)MeshOptions::read();
  } catch (const pdx::UserError& error) {
    return error.what();
  }
  return "none";
}
} // namespace

TEST(MeshOptions, BoxIsRead)
{
  const Given given({{"-mesh_lower", "-1,0"}, {"-mesh_upper", "2,0.5"}, {"-mesh_cells", "30,5"}});
  const MeshOptions options = MeshOptions::read();
  EXPECT_EQ(options.box.lower, pdx::Vector<2>(-1.0, 0.0));
  EXPECT_EQ(options.box.upper, pdx::Vector<2>(2.0, 0.5));
  EXPECT_EQ(options.cells, (std::array<pdx::Index, 2>{30, 5}));
  EXPECT_TRUE(options.file.empty());
}

TEST(MeshOptions, CellsMayBeLeftToTheScene)
{
  const Given given({{"-mesh_lower", "0,0"}, {"-mesh_upper", "1,1"}});
  const MeshOptions options = MeshOptions::read();
  EXPECT_EQ(options.cells, (std::array<pdx::Index, 2>{0, 0}));
  EXPECT_THROW(build(PETSC_COMM_WORLD, options, {}), pdx::UserError);
}

TEST(MeshOptions, NoMeshIsRefusedWithWhatToGive)
{
  const std::string error = refusal();
  EXPECT_NE(error.find("-mesh_file"), std::string::npos) << error;
  EXPECT_NE(error.find("-mesh_lower"), std::string::npos) << error;
}

TEST(MeshOptions, EmptyBoxIsRefused)
{
  const Given given({{"-mesh_lower", "0,1"}, {"-mesh_upper", "1,1"}});
  EXPECT_NE(refusal().find("must be below"), std::string::npos) << refusal();
}

TEST(MeshOptions, ZeroCellsAreRefused)
{
  const Given given({{"-mesh_lower", "0,0"}, {"-mesh_upper", "1,1"}, {"-mesh_cells", "4,0"}});
  EXPECT_NE(refusal().find("-mesh_cells"), std::string::npos) << refusal();
}

TEST(MeshOptions, UnknownPartitionerIsRefusedWithTheKnownOnes)
{
  const Given given({{"-mesh_lower", "0,0"}, {"-mesh_upper", "1,1"}, {"-petscpartitioner_type", "parmetis"}});
  EXPECT_NE(refusal().find("metis, straight, ptscotch, simple"), std::string::npos) << refusal();
}
