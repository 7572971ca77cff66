#include "pdx/geom/lattice.hpp"

#include <gtest/gtest.h>

using pdx::geom::Lattice;

TEST(Lattice, SitesSitInTheMiddleOfTheirCellsAlsoOutside)
{
  const Lattice<2> lattice{{1.0, -2.0}, 0.5, {4, 3}};
  EXPECT_TRUE(lattice.point({0, 0}).isApprox(pdx::Vector<2>(1.25, -1.75)));
  EXPECT_TRUE(lattice.point({3, 2}).isApprox(pdx::Vector<2>(2.75, -0.75)));
  EXPECT_TRUE(lattice.point({-1, 5}).isApprox(pdx::Vector<2>(0.75, 0.75)));
}

TEST(Lattice, NumbersRunAlongXFirst)
{
  const Lattice<3> lattice{{0, 0, 0}, 1.0, {4, 3, 2}};
  EXPECT_EQ(lattice.number({1, 0, 0}), 1);
  EXPECT_EQ(lattice.number({0, 1, 0}), 4);
  EXPECT_EQ(lattice.number({0, 0, 1}), 12);
  EXPECT_EQ(lattice.total(), 24);
  for (std::int64_t n = 0; n < lattice.total(); ++n) {
    EXPECT_TRUE(lattice.contains(lattice.site(n)));
    EXPECT_EQ(lattice.number(lattice.site(n)), n);
  }
}

TEST(Lattice, CountsMoreSitesThanAnIndexHolds)
{
  const Lattice<3> lattice{{0, 0, 0}, 1.0, {2000, 2000, 2000}};
  EXPECT_EQ(lattice.total(), 8'000'000'000);
  const pdx::Site<3> last{1999, 1999, 1999};
  EXPECT_EQ(lattice.site(lattice.number(last)), last);
}

TEST(Lattice, ContainsOnlyItsOwnSites)
{
  const Lattice<2> lattice{{0, 0}, 1.0, {4, 3}};
  EXPECT_TRUE(lattice.contains({3, 2}));
  EXPECT_FALSE(lattice.contains({4, 2}));
  EXPECT_FALSE(lattice.contains({3, 3}));
  EXPECT_FALSE(lattice.contains({-1, 0}));
}
