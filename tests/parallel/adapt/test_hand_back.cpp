#include "pdx/adapt/hand_back.hpp"

#include "support/scene.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/xfem/heaviside.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <map>

using namespace pdx;

namespace {
constexpr Index kAcross = 12; // elements of the unit square, per side
constexpr double kSide = 1.0 / kAcross;

geom::Box<2> cells_from(Index x0, Index y0, Index x1, Index y1) ///< in elements
{
  return {kSide * Vector<2>(x0, y0), kSide * Vector<2>(x1, y1)};
}

/// What lies above the crack, and what lies below, moves by a field of its own that elements carry exactly.
Vector<2> moved(const Vector<2>& x, xfem::Side side)
{
  return side == xfem::Side::plus ? Vector<2>(0.1 * x[0] + 1.0, 0.2 * x[1] - 0.3 * x[0] * x[1])
                                  : Vector<2>(-0.1 * x[1], 0.3 * x[0] + 0.5);
}

options::SceneOptions cracked_plate(const geom::Box<2>& patch, double height)
{
  options::SceneOptions options = test::with_patch(test::held_plate({kAcross, kAcross}), patch, kSide / 4.0);
  options.cracks.lines = {{{0.0, height}, {8.0 * kSide, height}}};
  return options;
}

/// Values of all rows that are owned; sets of nodes right of `from` are new and at rest.
struct Rows {
  std::vector<double> u;
  std::vector<Index> is_new;
};
Rows rows_of(test::Scene& scene, double height, double from)
{
  const scene::Discretisation& d = scene.d();
  const xfem::EnrichedSets& sets = *d.sets;
  Rows rows{std::vector<double>(2 * static_cast<std::size_t>(scene.rows().owned()), 0.0), {}};
  const auto put = [&rows](PetscInt row, const Vector<2>& value) {
    for (std::size_t k = 0; k < 2; ++k) rows.u[2 * static_cast<std::size_t>(row) + k] = value[static_cast<Index>(k)];
  };
  for (const Index v : d.nodes) {
    const Vector<2>& x = scene.mesh().point(v);
    const xfem::Side side = x[1] >= height - 1e-9 ? xfem::Side::plus : xfem::Side::minus;
    put(d.node_rows[static_cast<std::size_t>(v)] - scene.rows().first, moved(x, side));
    for (const xfem::EnrichedSet& set : sets.of(v)) {
      const PetscInt row = set.row - scene.rows().first;
      const xfem::Side other = xfem::opposite(set.side);
      if (x[0] > from + 1e-9)
        rows.is_new.push_back(row);
      else
        put(row, (moved(x, other) - moved(x, set.side)) / xfem::shifted_step(other, set.side));
    }
  }
  return rows;
}

struct Left {
  Index cell; ///< natural
  std::array<double, 2> at, u;
};

/// The same particles on the ranks of another scene, whose cells are dealt out otherwise.
adapt::Leaving dealt_out(const adapt::Leaving& left, test::Scene& from, test::Scene& to)
{
  std::vector<Left> mine;
  for (std::size_t k = 0; k < left.cells.size(); ++k)
    mine.push_back({from.mesh().natural_cell(left.cells[k]),
                    {left.places[k][0], left.places[k][1]},
                    {left.fields[0][2 * k], left.fields[0][2 * k + 1]}});
  std::map<Index, Index> here;
  for (Index c = 0; c < to.mesh().owned_cells(); ++c) here[to.mesh().natural_cell(c)] = c;
  adapt::Leaving there;
  std::vector<double> moved_there;
  for (const auto& [cell, at, u] : gather_all(from.mesh().comm(), mine)) {
    if (!here.contains(cell)) continue;
    there.cells.push_back(here[cell]);
    there.places.emplace_back(at[0], at[1]);
    for (const double value : u) moved_there.push_back(value);
  }
  there.fields.push_back(std::move(moved_there));
  return there;
}

/// The largest error with which elements carry the particles that left, once their sets are fitted.
double carried_error(double height)
{
  const geom::Box<2> uncovered = cells_from(3, 2, 6, 9);
  test::Scene before(cracked_plate(cells_from(3, 2, 9, 9), height)),
      after(cracked_plate(cells_from(6, 2, 9, 9), height));
  const auto field = [height](const Vector<2>& x) {
    return moved(x, x[1] > height ? xfem::Side::plus : xfem::Side::minus);
  };
  const std::vector<double> u = before.blocks(field);
  const std::span<const double> fields[] = {u};
  const adapt::Leaving left =
      dealt_out(adapt::leaving(before.d().view(before.mesh()), {&uncovered, 1}, fields), before, after);
  EXPECT_EQ(before.sum(static_cast<double>(left.cells.size())), 3.0 * 7.0 * 16.0);

  Rows rows = rows_of(after, height, 3.0 * kSide);
  EXPECT_GT(after.sum(static_cast<double>(rows.is_new.size())), 2.0);
  const std::span<double> filled[] = {rows.u};
  const adapt::SceneView view = after.d().view(after.mesh());
  adapt::fit_sets(view, left, rows.is_new, filled);
  std::vector<double> local;
  after.system().halo->fetch(rows.u, 2, local);
  double worst = 0.0;
  for (std::size_t k = 0; k < left.cells.size(); ++k) {
    const couple::Host host =
        couple::host_in_cell({view.mesh, view.node_rows, view.sets}, left.cells[k], left.places[k]);
    Vector<2> carried = Vector<2>::Zero();
    for (std::size_t a = 0; a < static_cast<std::size_t>(host.count); ++a) {
      const auto row = static_cast<std::size_t>(after.system().halo->local(host.rows[a]));
      carried += host.weights[a] * Vector<2>(local[2 * row], local[2 * row + 1]);
    }
    worst = std::max(worst, (carried - field(left.places[k])).norm());
  }
  return after.max(worst);
}
} // namespace

TEST(HandBack, SetsTakeWhatBothSidesOfACrackDo) { EXPECT_LT(carried_error(5.5 * kSide), 1e-11); }

TEST(HandBack, SetsOfACrackAlongALineOfTheMesh) { EXPECT_LT(carried_error(6.0 * kSide), 1e-11); }

TEST(HandBack, SetsOfACrackNextToNodes) { EXPECT_LT(carried_error(5.97 * kSide), 1e-9); }

TEST(HandBack, NamesEachSetThatThereMayBeOnce)
{
  test::Scene scene(cracked_plate(cells_from(3, 2, 9, 9), 5.5 * kSide));
  adapt::LayoutChange change;
  change.uncover = {cells_from(3, 2, 6, 9)};
  const adapt::FreshRows fresh = adapt::fresh_sets(scene.d().view(scene.mesh()), change, 2);
  for (const field::RowName name : fresh.names) EXPECT_EQ(name.kind(), field::RowName::Kind::set);
  EXPECT_EQ(fresh.fields.size(), 2u);
  EXPECT_EQ(fresh.fields[1].size(), 2 * fresh.names.size());
  EXPECT_EQ(scene.sum(static_cast<double>(fresh.names.size())), 4.0 * 8.0 - 2.0); // two nodes have theirs already
}
