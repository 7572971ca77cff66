#include "pdx/scene/layout.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/petsc.hpp"
#include "support/scratch_directory.hpp"

#include <gtest/gtest.h>

namespace {
using namespace pdx;

const Vector<2> kMouth(0.0, 0.5), kTip(0.4, 0.5), kFirst(0.6, 0.2), kLast(0.8, 0.2);

/// A unit square with an edge crack and one inside.
options::SceneOptions scene(options::Adapt adapt)
{
  options::SceneOptions options;
  options.mesh.box = {{0.0, 0.0}, {1.0, 1.0}};
  options.pd.patches = {{{0.25, 0.25}, {0.75, 0.75}}};
  options.pd.spacing = {0.05};
  options.cracks.lines = {{kMouth, kTip}, {kFirst, kLast}};
  options.layout.adapt = adapt;
  return options;
}

/// Why a checkpoint with these cracks is refused, "" if it is not.
std::string refusal(const std::vector<crack::Polyline>& cracks, options::Adapt adapt = options::Adapt::expand)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  scene::Layout layout = scene::Layout::given(scene(adapt));
  layout.cracks = cracks;
  io::Hdf5File file(PETSC_COMM_WORLD, scratch.path() / "layout.h5", io::Hdf5File::Mode::sealed);
  layout.write(file);
  file.close();
  try {
    const scene::Layout read =
        scene::Layout::read(io::SealedReader(PETSC_COMM_WORLD, scratch.path() / "layout.h5"), scene(adapt));
    EXPECT_EQ(read.cracks, cracks);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}
} // namespace

TEST(Layout, CracksOfACheckpointMayHaveGrownFromTheirTips)
{
  const Vector<2> on(0.5, 0.55), farther(0.6, 0.6), before(0.5, 0.2);
  EXPECT_EQ(refusal({{kMouth, kTip}, {kFirst, kLast}}), "");
  EXPECT_EQ(refusal({{kMouth, kTip, on}, {kFirst, kLast}}), "");
  EXPECT_EQ(refusal({{kMouth, kTip, on, farther}, {before, kFirst, kLast}}), "");
  EXPECT_EQ(refusal({{kMouth, kTip}, {before, kFirst, kLast, {0.9, 0.25}}}), "");
  EXPECT_EQ(refusal({{kMouth, kTip}, {kFirst, kLast}, {{0.1, 0.1}, {0.2, 0.1}}}), "") << "began or branched later";
  EXPECT_EQ(refusal({{kMouth, kTip}, {kFirst, kLast}}, options::Adapt::none), "");
}

TEST(Layout, OtherCracksOfACheckpointAreRefused)
{
  const Vector<2> on(0.5, 0.55), aside(0.0, 0.4);
  const crack::Polyline edge{kMouth, kTip}, inner{kFirst, kLast};
  for (const std::vector<crack::Polyline>& other :
       std::vector<std::vector<crack::Polyline>>{{edge},
                                                 {inner, edge},
                                                 {{aside, kMouth, kTip}, inner}, // a mouth does not grow
                                                 {{kMouth, on}, inner},
                                                 {{kMouth, {0.2, 0.5}, kTip}, inner},
                                                 {{kTip, kMouth}, inner},
                                                 {{kMouth}, inner}})
    EXPECT_NE(refusal(other).find("/layout_cracks is not where the cracks of this scene run"), std::string::npos)
        << other.size() << " cracks, " << other[0].size() << " points";
  EXPECT_NE(refusal({{kMouth, kTip, on}, inner}, options::Adapt::none), "") << "patches that stay";
  EXPECT_NE(refusal({edge, inner, {{0.1, 0.1}, {0.2, 0.1}}}, options::Adapt::none), "") << "patches that stay";
}
