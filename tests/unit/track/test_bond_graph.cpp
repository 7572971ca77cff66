#include "pdx/track/bond_graph.hpp"
#include "support/cracked_lattice.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using test::CrackedLattice;

namespace {
const geom::Box<2> kAll{{0.0, 0.0}, {12.0, 12.0}};

int body_of(const track::Bodies& bodies, const Site<2>& site)
{
  const auto found = std::ranges::find(bodies.sites, site);
  return found == bodies.sites.end() ? -1 : bodies.body[static_cast<std::size_t>(found - bodies.sites.begin())];
}

/// Against the sides of the line y = `height`.
bool are_sides_of(double height, const track::Bodies& bodies, const track::BondGraph& graph, double slack)
{
  return track::are_sides(
      bodies, graph, [&](const Vector<2>& x) { return x.y() > height ? 1 : 0; },
      [&](const Vector<2>& x) { return std::abs(x.y() - height); }, slack);
}
} // namespace

TEST(BondGraph, BondBeginsWhereBothEndsAndWhatIsBetweenAreParticles)
{
  const CrackedLattice plate({12, 12}, 3.0);
  const auto hole = [](const Site<2>& site) { return site[0] >= 0 && site[0] < 6 && site != Site<2>{3, 3}; };
  const track::BondGraph graph(plate.lattice, plate.stencil, hole);
  for (std::size_t h = 0; h < plate.stencil.half.size(); ++h) {
    const Site<2>& step = plate.stencil.half[h].step;
    EXPECT_EQ(graph.begins({2, 3}, h), step[0] < 1 || step[1] > 1 || step == Site<2>({1, 1}))
        << step[0] << " " << step[1];
  }
}

TEST(BondGraph, SitesLoseWhatIsAddedAndNothingElse)
{
  CrackedLattice plate({12, 12}, 4.0);
  plate.cut({{0.0, 6.0}, {12.0, 6.0}});
  const track::BondGraph graph = plate.graph();
  plate.for_each_bond([&](const CrackedLattice::Bond& bond) {
    for (std::size_t h = 0; h < plate.stencil.half.size(); ++h)
      if (graph.end_of(bond.first, h) == bond.second) {
        EXPECT_EQ(graph.gone(bond.first, h), bond.first[1] < 6 && bond.second[1] >= 6);
        EXPECT_NE(graph.gone(bond.first, h), graph.intact(bond.first, h));
      }
  });
}

TEST(Bodies, WindowHasTheParticlesInItAndOnItsBorder)
{
  const track::BondGraph graph = CrackedLattice({12, 12}, 3.0).graph();
  const track::Bodies bodies = track::bodies_in(graph, {{0.5, 1.5}, {3.5, 2.4}});
  const std::vector<Site<2>> row{{0, 1}, {1, 1}, {2, 1}, {3, 1}};
  EXPECT_EQ(bodies.sites, row);
  EXPECT_EQ(bodies.count, 1);
  EXPECT_EQ(track::bodies_in(graph, {{20.0, 20.0}, {24.0, 24.0}}).count, 0);
}

TEST(Bodies, CountInOrderOfRows)
{
  CrackedLattice plate({12, 12}, 3.0);
  plate.cut({{0.0, 6.0}, {12.0, 6.0}}).cut({{5.0, 6.0}, {5.0, 12.0}});
  const track::Bodies bodies = track::bodies_in(plate.graph(), kAll);
  EXPECT_EQ(bodies.count, 3);
  EXPECT_EQ(body_of(bodies, {11, 0}), 0);
  EXPECT_EQ(body_of(bodies, {0, 11}), 1);
  EXPECT_EQ(body_of(bodies, {11, 11}), 2);
}

TEST(Bodies, OnlyBondsWithinTheWindowHoldTogether)
{
  CrackedLattice plate({12, 12}, 3.0);
  plate.cut({{0.0, 6.0}, {8.0, 6.0}});
  EXPECT_EQ(track::bodies_in(plate.graph(), kAll).count, 1);
  EXPECT_EQ(track::bodies_in(plate.graph(), {{0.0, 0.0}, {8.0, 12.0}}).count, 2);
}

TEST(Sides, ABodyPerSide)
{
  CrackedLattice plate({12, 12}, 3.0);
  const track::BondGraph whole = plate.graph();
  EXPECT_TRUE(are_sides_of(-1.0, track::bodies_in(whole, kAll), whole, 1.0));
  EXPECT_FALSE(are_sides_of(6.0, track::bodies_in(whole, kAll), whole, 1.0)); // one body on two sides
  plate.cut({{0.0, 6.0}, {12.0, 6.0}});
  const track::BondGraph parted = plate.graph();
  EXPECT_TRUE(are_sides_of(6.0, track::bodies_in(parted, kAll), parted, 1.0));
  EXPECT_FALSE(are_sides_of(-1.0, track::bodies_in(parted, kAll), parted, 1.0)); // two bodies on one side
}

TEST(Sides, ParticlesNextToTheLineMayLieWrong)
{
  CrackedLattice plate({12, 12}, 3.0);
  plate.cut({{0.0, 6.0}, {12.0, 6.0}});
  const track::BondGraph graph = plate.graph();
  const track::Bodies bodies = track::bodies_in(graph, kAll);
  EXPECT_TRUE(are_sides_of(6.9, bodies, graph, 1.0));
  EXPECT_FALSE(are_sides_of(6.9, bodies, graph, 0.3));
  EXPECT_FALSE(are_sides_of(8.0, bodies, graph, 1.0));
}

TEST(Sides, CrumbsNextToTheLineDoNotCount)
{
  const auto loose = [](Index count, Index row) { // a bar of so many particles that nothing holds
    CrackedLattice plate({12, 12}, 3.0);
    plate.cut({{0.0, 6.0}, {12.0, 6.0}});
    const auto in_bar = [=](const Site<2>& s) { return s[1] == row && s[0] >= 3 && s[0] < 3 + count; };
    plate.for_each_bond([&](const CrackedLattice::Bond& bond) {
      if (in_bar(bond.first) != in_bar(bond.second)) plate.gone.insert(bond);
    });
    const track::BondGraph graph = plate.graph();
    return are_sides_of(6.0, track::bodies_in(graph, kAll), graph, 1.0);
  };
  EXPECT_TRUE(loose(1, 6));
  EXPECT_TRUE(loose(5, 5));
  EXPECT_TRUE(loose(5, 7));
  EXPECT_FALSE(loose(6, 6));
  EXPECT_FALSE(loose(2, 9));
}
