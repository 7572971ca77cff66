// Cracks that meet in elements, on a distributed mesh: what they cut out moves by itself, on any number of ranks.
#include "cut_body.hpp"
#include "pdx/xfem/halves.hpp"

#include <gtest/gtest.h>
#include <numbers>
#include <random>

namespace pdx::test::junctions {
namespace {
constexpr double kDensity = 3.0, kThickness = 0.2;

/// Straight half-lines from one place, in order of angles: bodies lie between them.
struct Star {
  Vector<2> middle;
  std::vector<double> angles;

  Vector<2> along(std::size_t k) const { return {std::cos(angles[k]), std::sin(angles[k])}; }
  std::size_t body(const Vector<2>& x) const
  {
    const double angle = std::atan2(x.y() - middle.y(), x.x() - middle.x());
    const auto next = std::ranges::upper_bound(angles, angle);
    return next == angles.end() ? 0 : static_cast<std::size_t>(next - angles.begin());
  }
  double narrowest() const
  {
    double least = 2.0 * std::numbers::pi + angles.front() - angles.back();
    for (std::size_t k = 1; k < angles.size(); ++k) least = std::min(least, angles[k] - angles[k - 1]);
    return least;
  }
};

enum class Kind { y, bent_y, t, x };

/// A star and cracks along it, all of which leave the body.
std::pair<Star, std::vector<crack::Polyline>> cracks_of(Kind kind, const Vector<2>& middle, std::mt19937& random)
{
  std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi);
  const auto opposite = [](double angle) { return angle + (angle > 0.0 ? -std::numbers::pi : std::numbers::pi); };
  Star star{middle, {}};
  while (star.angles.empty() || star.narrowest() < 0.3) {
    star.angles = {turn(random), turn(random)};
    star.angles.push_back(kind == Kind::y || kind == Kind::bent_y ? turn(random) : opposite(star.angles[0]));
    if (kind == Kind::x) star.angles.push_back(opposite(star.angles[1]));
    std::ranges::sort(star.angles);
  }
  const auto out = [&](std::size_t k) { return Vector<2>(middle + 10.0 * star.along(k)); };
  if (kind == Kind::x) return {star, {{out(0), out(2)}, {out(1), out(3)}}};
  if (kind == Kind::y) return {star, {{out(0), middle}, {out(1), middle}, {out(2), middle}}};
  if (kind == Kind::bent_y) return {star, {{out(0), middle, out(1)}, {out(2), middle}}};
  for (std::size_t k = 0; k < 3; ++k) // the branch is the one with nothing opposite
    if (std::ranges::none_of(star.angles, [&](double a) { return std::abs(a - opposite(star.angles[k])) < 1e-9; }))
      return {star, {{out((k + 1) % 3), out((k + 2) % 3)}, {out(k), middle}}};
  return {star, {}};
}

/// Area of the unit square on the left of a line and of others.
double area_between(const Star& star, std::size_t k)
{
  geom::Polygon shape{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}};
  const std::size_t before = (k + star.angles.size() - 1) % star.angles.size();
  const std::pair<Vector<2>, double> lines[] = {{star.along(before), 1.0}, {star.along(k), -1.0}};
  for (const auto& [along, sign] : lines) {
    std::vector<double> distance;
    for (const Vector<2>& x : shape)
      distance.push_back(sign * (along.x() * (x - star.middle).y() - along.y() * (x - star.middle).x()));
    if (!shape.empty()) shape = geom::split(shape, distance).plus;
  }
  return geom::area(shape);
}

std::vector<double> areas_of(const Star& star)
{
  std::vector<double> areas(star.angles.size(), -1.0);
  double convex = 0.0;
  for (std::size_t k = 0; k < areas.size(); ++k) {
    const double wide = star.angles[k] - (k ? star.angles[k - 1] : star.angles.back() - 2.0 * std::numbers::pi);
    if (wide < std::numbers::pi - 1e-9) convex += areas[k] = area_between(star, k);
  }
  for (double& area : areas)
    if (area < 0.0) area = 1.0 - convex; // one at most
  return areas;
}

/// A place in the body that a set moves: the middle of what of it lies in a cell of its node.
Vector<2> place_of(const CutBody& body, Index vertex, const xfem::EnrichedSet& set)
{
  const auto middle = [](const geom::Polygon& outline) {
    Vector<2> sum = Vector<2>::Zero();
    for (const Vector<2>& x : outline) sum += x;
    return Vector<2>(sum / static_cast<double>(outline.size()));
  };
  Vector<2> found = xfem::halves_of(body.mesh, body.sets, vertex, set).far;
  double largest = 0.0;
  const auto look = [&](const geom::Polygon& outline) {
    if (outline.empty() || geom::area(outline) <= largest) return;
    largest = geom::area(outline);
    found = middle(outline);
  };
  for (const xfem::CutElement& cut : body.sets.cells()) {
    const auto& cell = body.mesh.cell(cut.cell);
    const auto at = std::ranges::find(cell, vertex);
    if (at == cell.end()) continue;
    if (cut.piece) {
      if (cut.piece->set[static_cast<std::size_t>(at - cell.begin())] == set.crack) look(cut.piece->outlines[0]);
    } else if (cut.crack == set.crack && !cut.snapped) {
      const geom::Split parts = geom::split(body.mesh.corners(cut.cell), cut.distance);
      look(set.side == xfem::Side::plus ? parts.minus : parts.plus);
    }
  }
  return found;
}

CutBodyOptions options_of(std::vector<crack::Polyline> cracks, int cells)
{
  CutBodyOptions options;
  options.cracks = std::move(cracks);
  options.grid.cells = {cells, cells};
  options.law.density = kDensity;
  return options;
}
} // namespace

TEST(Junctions, MassOfEachBodyIsExact)
{
  std::mt19937 random(11); // alike on every rank
  std::uniform_real_distribution<double> place(0.2, 0.8);
  int whole = 0, ranks = 1;
  MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
  const int tries = ranks == 1 ? 200 : 60;
  for (int number = 0; number < tries; ++number) {
    const Kind kind = std::array{Kind::y, Kind::t, Kind::x}[static_cast<std::size_t>(number % 3)];
    Vector<2> middle(place(random), place(random));
    if (number % 3 == 0) middle.x() = 0.5 + 1e-3 * (place(random) - 0.5); // near an edge
    if (number % 6 == 0) middle.y() = 0.5;                                // on one, or by a node
    const auto [star, lines] = cracks_of(kind, middle, random);
    const CutBody body(options_of(lines, 4));
    std::vector<double> mass(static_cast<std::size_t>(body.rows.owned()), 0.0), of_body(star.angles.size(), 0.0);
    for (const auto& term : body.terms) term->add_mass(mass);
    for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
      const auto row = static_cast<std::size_t>(body.node_rows[static_cast<std::size_t>(v)] - body.rows.first);
      of_body[star.body(body.mesh.point(v))] += mass[row];
      for (const xfem::EnrichedSet& set : body.sets.of(v))
        of_body[star.body(place_of(body, v, set))] += mass[static_cast<std::size_t>(set.row - body.rows.first)];
    }
    const std::vector<double> areas = areas_of(star);
    double total = 0.0;
    for (std::size_t k = 0; k < areas.size(); ++k) {
      of_body[k] = body.sum(of_body[k]) / (kDensity * kThickness);
      total += of_body[k];
    }
    EXPECT_NEAR(total, 1.0, 1e-12) << "number " << number;
    if (body.sets.report().dropped > 0) continue; // slivers went with what is beside them
    ++whole;
    for (std::size_t k = 0; k < areas.size(); ++k)
      EXPECT_NEAR(of_body[k], areas[k], 1e-12) << "number " << number << ", body " << k;
  }
  EXPECT_GT(whole, tries / 2);
}

// A sliver is given up by copies in an element that has nodes without copies: their sets have nothing left there.
TEST(Junctions, NoSetIsLeftWithNothingToMove)
{
  CutBody body(options_of({{{0.91630175831360616, 1.0}, {0.041849120290573361, 0.0}},
                           {{0.59786676963328156, 1.0}, {0.20772323261991604, 0.0}}},
                          3));
  std::vector<double> mass(static_cast<std::size_t>(body.rows.owned()), 0.0);
  for (const auto& term : body.terms) term->add_mass(mass);
  for (const double of_row : mass) EXPECT_GT(of_row, 1e-6); // of 0.6
  EXPECT_GT(body.sets.report().dropped, 0);
}

TEST(Junctions, BodiesMoveRigidlyWithoutForce)
{
  std::mt19937 random(5);
  for (int number = 0; number < 24; ++number) {
    // What bends right behind an edge pokes into an element that it does not cut.
    const Kind kind =
        number == 1 ? Kind::bent_y : std::array{Kind::y, Kind::t, Kind::x}[static_cast<std::size_t>(number % 3)];
    const double away = number < 4 ? 0.11 : number < 8 ? 1e-3 : number < 12 ? 1e-6 : number < 16 ? 1e-10 : 0.0;
    const Vector<2> middle(0.5 + away, number % 8 < 4 ? 0.5 + away : 0.61);
    const auto [star, lines] = cracks_of(kind, middle, random);
    CutBody body(options_of(lines, 4));
    const auto motion = [&](const Vector<2>& x, std::size_t k) {
      const double turn = 0.1 * static_cast<double>(k + 1);
      return Vector<2>(turn * -x.y() + 0.3 * static_cast<double>(k), turn * x.x() - 0.2);
    };
    std::vector<double> u(static_cast<std::size_t>(2 * body.rows.owned()), 0.0);
    std::vector<int> at_node(static_cast<std::size_t>(body.mesh.vertices())); // body of each node's own row
    const auto put = [&](PetscInt row, const Vector<2>& value) {
      const auto at = static_cast<std::size_t>(2 * (row - body.rows.first));
      u[at] = value.x();
      u[at + 1] = value.y();
    };
    for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
      const Vector<2>& x = body.mesh.point(v);
      Vector<2> inside = x; // what lies on a crack is on one side of it
      for (const xfem::EnrichedSet& set : body.sets.of(v)) inside -= 1e-6 * (place_of(body, v, set) - x).normalized();
      const Vector<2> own = motion(x, star.body(inside));
      put(body.node_rows[static_cast<std::size_t>(v)], own);
      for (const xfem::EnrichedSet& set : body.sets.of(v))
        put(set.row, (motion(x, star.body(place_of(body, v, set))) - own) /
                         xfem::shifted_step(xfem::opposite(set.side), set.side));
    }
    if (body.sets.report().dropped > 0) continue;
    EXPECT_LT(body.norm(body.internal_force(u)), 1e-12) << "number " << number;
    EXPECT_LT(body.energy(u), 1e-12) << "number " << number;
  }
}

TEST(Junctions, EnergyIsThatOfTheBodiesAlone)
{
  // One body of three stretched, the others at rest.
  const Star star{{0.53, 0.47}, {-2.3, 0.4, 1.9}};
  const auto out = [&](std::size_t k) { return Vector<2>(star.middle + 10.0 * star.along(k)); };
  CutBody body(options_of({{out(0), star.middle}, {out(1), star.middle}, {out(2), star.middle}}, 5));
  const double stretch = 1e-3;
  const auto field = [&](const Vector<2>& x, std::size_t k) {
    return k == 1 ? Vector<2>(stretch * x.x(), -0.3 * stretch * x.y()) : Vector<2>(0.0, 0.0);
  };
  std::vector<double> u(static_cast<std::size_t>(2 * body.rows.owned()), 0.0);
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v) {
    const Vector<2>& x = body.mesh.point(v);
    const Vector<2> own = field(x, star.body(x));
    const auto at = static_cast<std::size_t>(2 * (body.node_rows[static_cast<std::size_t>(v)] - body.rows.first));
    u[at] = own.x();
    u[at + 1] = own.y();
    for (const xfem::EnrichedSet& set : body.sets.of(v)) {
      const Vector<2> a =
          (field(x, star.body(place_of(body, v, set))) - own) / xfem::shifted_step(xfem::opposite(set.side), set.side);
      const auto set_at = static_cast<std::size_t>(2 * (set.row - body.rows.first));
      u[set_at] = a.x();
      u[set_at + 1] = a.y();
    }
  }
  // Uniaxial stress E e over one body: E e^2 / 2 a unit of volume.
  const double expected = 0.5 * 10.0 * stretch * stretch * kThickness * areas_of(star)[1];
  EXPECT_NEAR(body.energy(u), expected, 1e-10 * expected);
}

TEST(Junctions, AnEndThatNothingPartsPartsNothing)
{
  const CutBody body(options_of({{{0.41, 0.4}, {0.41, 0.45}}, {{0.41, 0.45}, {0.45, 0.45}}}, 4));
  EXPECT_EQ(body.sets.report().cells, 0);
  EXPECT_EQ(body.sets.report().sets, 0);
  EXPECT_EQ(body.sets.report().closed.size(), 2u); // and is told
}

TEST(Junctions, TwoCracksPartACellTogetherThatNeitherRunsThrough)
{
  const CutBody body(options_of({{{0.0, 0.42}, {0.4, 0.41}}, {{1.0, 0.83}, {0.4, 0.41}}}, 4));
  std::vector<double> u(static_cast<std::size_t>(2 * body.rows.owned()), 0.0);
  for (Index v = 0; v < body.mesh.owned_vertices(); ++v) // what lies above is lifted
    for (std::size_t k = 0; k <= body.sets.of(v).size(); ++k) {
      const xfem::EnrichedSet* set = k ? &body.sets.of(v)[k - 1] : nullptr;
      const auto lifted = [](const Vector<2>& x) {
        const double crack = x.x() < 0.4 ? 0.42 - 0.025 * x.x() : 0.41 + 0.7 * (x.x() - 0.4);
        return x.y() > crack ? 1.0 : 0.0;
      };
      const double own = lifted(body.mesh.point(v));
      const double value =
          set ? (lifted(place_of(body, v, *set)) - own) / xfem::shifted_step(xfem::opposite(set->side), set->side)
              : own;
      const PetscInt row = set ? set->row : body.node_rows[static_cast<std::size_t>(v)];
      u[static_cast<std::size_t>(2 * (row - body.rows.first) + 1)] = value;
    }
  EXPECT_GT(body.sum(static_cast<double>(body.sets.owned())), 0.0);
  EXPECT_LT(body.energy(u), 1e-20); // of some 1 were it one body
}
} // namespace pdx::test::junctions
