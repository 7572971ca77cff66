#include "pdx/law/fracture.hpp"
#include "pdx/mesh/build.hpp"
#include "pdx/post/tip_modes.hpp"

#include <gtest/gtest.h>
#include <map>
#include <numbers>

using namespace pdx;

namespace {
constexpr double kK = 2.0; // [Pa m^0.5]

/// Mode I, and if asked for mode II and uniform stress along the crack, near the tip [Williams, 1957] of a crack in the
/// origin that grows along `direction`, as the field left (side +1) or right (-1) of the crack, each continued smoothly
/// across it; side 0: the branch of the point itself.
struct Williams {
  law::Elastic law;
  Vector<2> direction = Vector<2>::UnitX();
  double opening = kK, sliding = 0.0, along = 0.0; ///< K_I, K_II [Pa m^0.5], stress along the crack [Pa]

  Vector<2> at(const Vector<2>& x, int side) const
  {
    const Tensor<2> frame{{direction.x(), direction.y()}, {-direction.y(), direction.x()}};
    const Vector<2> y = frame * x;
    double angle = std::atan2(y.y(), y.x());
    if (side > 0 && angle < -0.5 * std::numbers::pi) angle += 2.0 * std::numbers::pi;
    if (side < 0 && angle > 0.5 * std::numbers::pi) angle -= 2.0 * std::numbers::pi;
    const double nu = law.poisson, c = std::cos(0.5 * angle), s = std::sin(0.5 * angle);
    const double kappa = law.plane == law::Plane::stress ? (3.0 - nu) / (1.0 + nu) : 3.0 - 4.0 * nu;
    const double scale = 1.0 / (2.0 * law.mu()) * std::sqrt(y.norm() / (2.0 * std::numbers::pi));
    const Vector<2> one(c * (kappa - 1.0 + 2.0 * s * s), s * (kappa + 1.0 - 2.0 * c * c));
    const Vector<2> two(s * (kappa + 1.0 + 2.0 * c * c), -c * (kappa - 1.0 - 2.0 * s * s));
    const Vector<2> uniform = along / (8.0 * law.mu()) * Vector<2>((kappa + 1.0) * y.x(), (kappa - 3.0) * y.y());
    return frame.transpose() * (scale * (opening * one + sliding * two) + uniform);
  }
};

/// [-1, 1]^2 with the crack through the cells: the field at the vertices, and both sides of the cut cells.
class KField {
public:
  KField(const law::Elastic& law, const Vector<2>& direction, Index cells)
      : KField(Williams{law, direction, kK, 0.0, 0.0}, cells)
  {}
  KField(const Williams& field, Index cells) : field_(field), mesh_(build(cells))
  {
    tip_.direction = field.direction;
    for (Index v = 0; v < mesh_.vertices(); ++v) {
      const Vector<2> value = field_.at(mesh_.point(v), 0);
      u_.insert(u_.end(), {value.x(), value.y()});
    }
    for (Index c = 0; c < mesh_.cells(); ++c) cut(c);
  }

  mesh::Mesh& mesh() { return mesh_; }

  double j(const post::DomainRing& ring, law::Kinematics kinematics = law::Kinematics::small) const
  {
    return post::domain_j({mesh_, field_.law, kinematics}, tip_, ring, u_, parts());
  }
  post::TipModes modes(const post::DomainRing& ring) const
  {
    const auto side = [this](const Vector<2>& x) {
      return tip_.direction.x() * x.y() - tip_.direction.y() * x.x() >= 0.0 ? 1 : -1;
    };
    return post::domain_modes({mesh_, field_.law, law::Kinematics::small}, tip_, ring, u_, side, parts());
  }
  double exact() const { return kK * kK / law::crack_modulus(field_.law); }

private:
  static mesh::Mesh build(Index cells)
  {
    mesh::MeshOptions options;
    options.box = {{-1.0, -1.0}, {1.0, 1.0}};
    options.cells = {cells, cells};
    return mesh::build(PETSC_COMM_WORLD, options, [](const auto&) { return 1; });
  }

  /// Cuts the cell if the crack runs through it.
  void cut(Index c)
  {
    const fem::Corners corners = mesh_.corners(c);
    xfem::CornerDistances distance;
    bool behind = true, left = false, right = false;
    for (std::size_t a = 0; a < 4; ++a) {
      distance[a] = tip_.direction.x() * corners[a].y() - tip_.direction.y() * corners[a].x();
      behind &= tip_.direction.dot(corners[a]) < 0.0;
      (distance[a] >= 0.0 ? left : right) = true;
    }
    if (!(behind && left && right)) return;
    mesh_.cut(c);
    cut_.emplace(c, xfem::cut_cell(corners, distance, xfem::Quadrature::polygons));
  }

  post::CellParts parts() const
  {
    return [this](Index c, std::vector<post::PartOfCell>& parts) {
      for (const xfem::Side side : {xfem::Side::minus, xfem::Side::plus})
        parts.push_back({cut_.at(c).points(side), values(c, side == xfem::Side::plus ? 1 : -1)});
    };
  }

  fem::ElementVector values(Index c, int side) const
  {
    fem::ElementVector values;
    for (std::size_t a = 0; a < 4; ++a)
      values.segment<2>(static_cast<Eigen::Index>(2 * a)) = field_.at(mesh_.corners(c)[a], side);
    return values;
  }

  Williams field_;
  mesh::Mesh mesh_;
  crack::Tip tip_;
  std::vector<double> u_;
  std::map<Index, xfem::CutCell> cut_;
};

const law::Elastic kPlate{3.0, 1.0 / 3.0, law::Plane::stress, 0.5};
const law::Elastic kThick{3.0, 0.25, law::Plane::strain, 0.5};
} // namespace

TEST(DomainJ, OfTheKFieldIsKSquaredOverE)
{
  const KField field(kPlate, Vector<2>::UnitX(), 61);
  for (const post::DomainRing& ring : {post::DomainRing{0.4, 0.8}, {0.3, 0.5}, {0.5, 0.9}}) {
    EXPECT_NEAR(field.j(ring), field.exact(), 5e-4 * field.exact()) << ring.inner;
    EXPECT_NEAR(law::stress_intensity(field.j(ring), kPlate), kK, 3e-4 * kK);
  }
}

TEST(DomainJ, OfTheKFieldInPlaneStrain)
{
  const KField field(kThick, Vector<2>::UnitX(), 61);
  EXPECT_NEAR(field.exact(), kK * kK * (1.0 - 0.0625) / 3.0, 1e-14);
  EXPECT_NEAR(field.j({0.4, 0.8}), field.exact(), 5e-4 * field.exact());
}

TEST(DomainJ, FollowsTheDirectionOfTheCrack)
{
  for (const double angle : {0.5 * std::numbers::pi, 2.5, -0.4}) {
    const KField field(kPlate, {std::cos(angle), std::sin(angle)}, 61);
    EXPECT_NEAR(field.j({0.4, 0.8}), field.exact(), 5e-3 * field.exact()) << angle;
  }
}

TEST(DomainJ, ErrsLessOnFinerMeshes)
{
  const KField coarse(kPlate, Vector<2>::UnitX(), 31), fine(kPlate, Vector<2>::UnitX(), 63);
  const double first = std::abs(coarse.j({0.4, 0.8}) - coarse.exact());
  EXPECT_LT(std::abs(fine.j({0.4, 0.8}) - fine.exact()), 0.4 * first);
}

TEST(DomainJ, LooksAtTheRingOnly)
{
  KField field(kPlate, Vector<2>::UnitX(), 61);
  const double before = field.j({0.4, 0.8});
  for (Index c = 0; c < field.mesh().cells(); ++c)
    if (field.mesh().centroid(c).lpNorm<Eigen::Infinity>() < 0.3) field.mesh().cover(c, 0);
  EXPECT_EQ(field.j({0.4, 0.8}), before);
  EXPECT_THROW(field.j({0.2, 0.8}), UserError);
}

TEST(DomainJ, RingsThatAreEmptyOrLeaveTheBodyAreRefused)
{
  const KField field(kPlate, Vector<2>::UnitX(), 21);
  EXPECT_THROW(field.j({0.5, 0.5}), UserError);
  EXPECT_THROW(field.j({0.0, 0.5}), UserError);
  EXPECT_THROW(field.j({0.5, 1.01}), UserError);
  EXPECT_NO_THROW(field.j({0.5, 0.99}));
}

// At these tiny strains a St Venant-Kirchhoff solid is a linear one.
TEST(DomainJ, OfFiniteStrainTendsToThatOfSmallStrain)
{
  law::Elastic stiff = kPlate;
  stiff.young = 1e7;
  const KField field(stiff, Vector<2>::UnitX(), 61);
  const double small = field.j({0.4, 0.8});
  EXPECT_NEAR(field.j({0.4, 0.8}, law::Kinematics::finite), small, 1e-5 * small);
}

TEST(TipModes, AreThoseOfTheField)
{
  for (const law::Elastic& law : {kPlate, kThick})
    for (const double angle : {0.0, 2.5, -0.4}) {
      const KField field({law, {std::cos(angle), std::sin(angle)}, 2.0, -1.5, 0.8}, 61);
      const post::TipModes modes = field.modes({0.4, 0.8});
      EXPECT_NEAR(modes.opening, 2.0, 0.005) << angle;
      EXPECT_NEAR(modes.sliding, -1.5, 0.005) << angle;
      EXPECT_NEAR(modes.along, 0.8, 0.01) << angle;
      EXPECT_NEAR(field.j({0.4, 0.8}), 6.25 / law::crack_modulus(law), 0.005 * 6.25 / law::crack_modulus(law));
    }
}

TEST(StressIntensity, OfNoReleaseIsZero)
{
  EXPECT_EQ(law::stress_intensity(0.0, kPlate), 0.0);
  EXPECT_EQ(law::stress_intensity(-1.0, kPlate), 0.0);
  EXPECT_NEAR(law::stress_intensity(12.0, kPlate), 6.0, 1e-14);
  EXPECT_NEAR(law::stress_intensity(12.0, kThick), std::sqrt(12.0 * 3.0 * 16.0 / 15.0), 1e-13);
}
