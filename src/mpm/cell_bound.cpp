#include "pdx/mpm/cell_bound.hpp"

#include "pdx/base/symmetric.hpp"

#include <cmath>

namespace pdx::mpm {
namespace {
constexpr double kPerUnit = 1e12; // weights are told apart to this

/// Adds value * (u_A x u_B) in the plane of directions i, j to twice the energy of a matrix.
template <int Dim> void add_cross(CellMatrix<Dim>& k, int a, int b, int i, int j, double value)
{
  const auto add = [&](int row, int column, double by) {
    k(row, column) += by;
    k(column, row) += by;
  };
  add(a * Dim + i, b * Dim + j, 0.5 * value);
  add(a * Dim + j, b * Dim + i, -0.5 * value);
}

/// Twice the part of a face in the integral of the minors: half of u_A x u_B over each part in the plane of its normal
/// and one direction in it, blended to the levels of the other.
template <int Dim>
void add_minors(const BodyMaterial& body, int face, std::uint16_t shared, double factor, CellMatrix<Dim>& k)
{
  const int normal = face / 2, low = face % 2 << normal;
  const double out = face % 2 ? factor : -factor;
  if constexpr (Dim == 2) {
    const int along = 1 - normal;
    const double part = body.elastic.thickness * std::popcount(shared) / body.ratio;
    add_cross<2>(k, low, low | 1 << along, normal, along, out * part);
  } else {
    for (int turn = 1; turn <= 2; ++turn) {
      const int along = (normal + turn) % 3, across = 3 - normal - along;
      for (int level = 0; level < body.ratio; ++level) {
        int parts = 0;
        for (int m = 0; m < body.ratio; ++m)
          parts += shared >> (along < across ? level * body.ratio + m : m * body.ratio + level) & 1;
        const double place = (level + 0.5) / body.ratio, share[2] = {1.0 - place, place};
        for (int a = 0; a < 2; ++a)
          for (int b = 0; b < 2; ++b)
            add_cross<3>(k, low | a << across, low | b << across | 1 << along, normal, along,
                         out * share[a] * share[b] * body.spacing * parts / body.ratio);
      }
    }
  }
}
} // namespace

template <int Dim> SharedParts<Dim> points_at_faces(int ratio, std::uint64_t mask)
{
  SharedParts<Dim> parts{};
  for_each_point(mask, [&](int site) {
    for (int d = 0, below = 1; d < Dim; ++d, below *= ratio) {
      const int place = site / below % ratio, part = site / (below * ratio) * below + site % below;
      if (place == 0) parts[static_cast<std::size_t>(2 * d)] |= static_cast<std::uint16_t>(1U << part);
      if (place == ratio - 1) parts[static_cast<std::size_t>(2 * d + 1)] |= static_cast<std::uint16_t>(1U << part);
    }
  });
  return parts;
}

template <int Dim>
double CellBounds<Dim>::stiffest(const CellPoints<Dim>& points, const SharedParts<Dim>& shared,
                                 const CornerValues<Dim>& weights)
{
  Weights rounded;
  for (std::size_t a = 0; a < rounded.size(); ++a)
    rounded[a] = std::llround(kPerUnit * weights[static_cast<Eigen::Index>(a)]);
  const Key key{points.mask, shared, rounded};
  if (last_ && last_->first == key) return last_->second;
  const auto [at, fresh] = known_.try_emplace(key, 0.0);
  last_ = &*at;
  if (!fresh) return at->second;
  const auto [matrix, new_matrix] = matrices_.try_emplace({points.mask, shared}, CellMatrix<Dim>::Zero());
  CellMatrix<Dim>& k = matrix->second;
  if (new_matrix) {
    const double lambda = law_tangent<Dim>(body_, Tensor<Dim>::Zero())(0, Dim + 1);
    k = cell_tangent<Dim>(body_, points, CellVector<Dim>::Zero());
    for (std::size_t face = 0; face < shared.size(); ++face)
      add_minors<Dim>(body_, static_cast<int>(face), shared[face], -lambda, k);
  }
  CellVector<Dim> scale;
  for (std::size_t a = 0; a < rounded.size(); ++a)
    scale.template segment<Dim>(static_cast<Eigen::Index>(a) * Dim)
        .setConstant(std::sqrt(kPerUnit / static_cast<double>(rounded[a])));
  const CellMatrix<Dim> scaled = scale.asDiagonal() * k * scale.asDiagonal();
  const Eigen::VectorXd all = symmetric_eigenvalues(scaled);
  return at->second = all[all.size() - 1];
}

template SharedParts<2> points_at_faces<2>(int, std::uint64_t);
template SharedParts<3> points_at_faces<3>(int, std::uint64_t);
template class CellBounds<2>;
template class CellBounds<3>;
} // namespace pdx::mpm
