#include "pdx/scene/patches.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace test_patches {
using namespace pdx;

/// A chain of five boxes and one of two, apart from it: two patches, in whatever order they are given.
TEST(Patches, BoxesThatTouchAreOnePatchInAnyOrder)
{
  const auto unit = [](double x, double y) { return geom::Box<2>{{x, y}, {x + 1.0, y + 1.0}}; };
  const std::vector<geom::Box<2>> boxes{unit(0, 0), unit(1, 0), unit(2, 1), unit(2, 2),
                                        unit(1, 3), unit(6, 0), unit(7, 0)};
  std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6};
  do {
    options::SceneOptions options;
    options.mesh.box = {{0.0, 0.0}, {8.0, 8.0}};
    options.pd.spacing = {0.5};
    for (const std::size_t k : order) options.pd.patches.push_back(boxes[k]);
    std::vector<std::size_t> sites;
    for (const couple::PatchShape& shape : scene::patch_shapes(options)) sites.push_back(shape.boxes.size());
    std::ranges::sort(sites);
    ASSERT_EQ(sites, (std::vector<std::size_t>{1, 5}))
        << testing::PrintToString(order); // two boxes side by side are one
  } while (std::ranges::next_permutation(order).found);
}
} // namespace test_patches
