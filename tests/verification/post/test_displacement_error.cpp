#include "pdx/mesh/build.hpp"
#include "pdx/post/error_norm.hpp"

#include <gtest/gtest.h>

using namespace pdx;

namespace {
// Six vertices: x = 0, 1, 2 and y = 0, 1. The reference is u = (x, 0): 0 at the left, which Eq. 28 leaves out.
mesh::Mesh two_cells()
{
  mesh::MeshOptions options;
  options.box = {{0.0, 0.0}, {2.0, 1.0}};
  options.cells = {2, 1};
  return mesh::build(PETSC_COMM_WORLD, options, [](const auto&) { return 1; });
}

template <class Field> std::vector<double> at_vertices(const mesh::Mesh& mesh, Field&& field)
{
  std::vector<double> u;
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const Vector<2> value = field(mesh.point(v));
    u.insert(u.end(), {value.x(), value.y()});
  }
  return u;
}

Vector<2> reference(const Vector<2>& x) { return {x.x(), 0.0}; }

bool is_at(const Vector<2>& x, double a, double b) { return (x - Vector<2>(a, b)).norm() < 1e-9; }

Vector<2> found(const Vector<2>& x)
{
  if (is_at(x, 0.0, 0.0)) return {0.3, 0.0}; // no relative error, but a vector error
  if (is_at(x, 1.0, 0.0)) return {0.0, 1.1}; // 10 % of magnitude; vector error sqrt(1 + 1.21)
  if (is_at(x, 2.0, 1.0)) return {1.9, 0.0}; // 5 %; vector error 0.1
  return reference(x);
}
} // namespace

TEST(DisplacementError, ByHand)
{
  const mesh::Mesh mesh = two_cells();
  const auto error = post::compare_displacement(mesh, at_vertices(mesh, found), at_vertices(mesh, reference));
  EXPECT_NEAR(error.max_relative_percent, 10.0, 1e-12);
  EXPECT_NEAR(error.mean_relative_percent, (10.0 + 5.0 + 0.0 + 0.0) / 4.0, 1e-12);
  EXPECT_NEAR(error.vector_l2_percent, 100.0 * std::sqrt((2.21 + 0.01 + 0.09) / 10.0), 1e-12);
  EXPECT_NEAR(error.vector_max_percent, 100.0 * std::sqrt(2.21) / 2.0, 1e-12);
  ASSERT_EQ(error.relative_percent.size(), static_cast<std::size_t>(mesh.owned_vertices()));
  for (Index v = 0; v < mesh.owned_vertices(); ++v) {
    const Vector<2>& x = mesh.point(v);
    EXPECT_NEAR(error.relative_percent[static_cast<std::size_t>(v)],
                is_at(x, 1.0, 0.0)   ? 10.0
                : is_at(x, 2.0, 1.0) ? 5.0
                                     : 0.0,
                1e-12);
  }
}

TEST(DisplacementError, ATurnedDisplacementHasNoRelativeErrorButAVectorError)
{
  const mesh::Mesh mesh = two_cells();
  const auto turned = at_vertices(mesh, [](const Vector<2>& x) { return Vector<2>(0.0, x.x()); });
  const auto error = post::compare_displacement(mesh, turned, at_vertices(mesh, reference));
  EXPECT_EQ(error.max_relative_percent, 0.0);
  EXPECT_NEAR(error.vector_l2_percent, 100.0 * std::sqrt(2.0), 1e-12);
}

TEST(DisplacementError, NothingAgainstNothingIsNoError)
{
  const mesh::Mesh mesh = two_cells();
  const std::vector<double> zero(2 * static_cast<std::size_t>(mesh.vertices()), 0.0);
  const auto error = post::compare_displacement(mesh, zero, zero);
  EXPECT_EQ(error.max_relative_percent, 0.0);
  EXPECT_EQ(error.mean_relative_percent, 0.0);
  EXPECT_EQ(error.vector_l2_percent, 0.0);
  EXPECT_EQ(error.vector_max_percent, 0.0);
}
