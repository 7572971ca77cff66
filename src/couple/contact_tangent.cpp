#include "pdx/couple/contact_tangent.hpp"

#include <Eigen/LU>

namespace pdx::couple {
/// d^2 / 2 is the least, over places w of the facet, of f = |x - sum w_i x_i|^2 / 2: its second derivative is that of f
/// at fixed w, less f_zw f_ww^-1 f_wz, where w goes along the edges e_j = x_j - x_0 of those corners that have a
/// weight.
template <int Dim>
ContactMatrix<Dim> contact_tangent(const Touch<Dim>& touch, std::span<const Vector<Dim>> corners, double stiffness)
{
  const auto count = static_cast<Eigen::Index>(corners.size()), size = Dim * (1 + count);
  const Vector<Dim> from = touch.distance * touch.normal;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Dim + 1, 1> share(1 + count); // of each place in x - sum w_i x_i
  std::array<Eigen::Index, Dim> active{};
  Eigen::Index used = 0;
  share[0] = 1.0;
  for (Eigen::Index c = 0; c < count; ++c) {
    const double w = touch.weights[static_cast<std::size_t>(c)];
    share[1 + c] = -w;
    if (w > 0.0) active[static_cast<std::size_t>(used++)] = c;
  }
  ContactMatrix<Dim> second = ContactMatrix<Dim>::Zero(size, size);          // of d^2 / 2
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Dim*(Dim + 1), 1> slope(size); // of d
  for (Eigen::Index a = 0; a <= count; ++a) {
    slope.segment(Dim * a, Dim) = share[a] * touch.normal;
    for (Eigen::Index b = 0; b <= count; ++b)
      second.block(Dim * a, Dim * b, Dim, Dim).diagonal().setConstant(share[a] * share[b]);
  }
  if (used > 1) {
    Eigen::Matrix<double, Dim, Eigen::Dynamic, 0, Dim, Dim> edges(Dim, used - 1);
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Dim*(Dim + 1), Dim> mixed =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Dim*(Dim + 1), Dim>::Zero(size, used - 1);
    const Eigen::Index first = active[0];
    for (Eigen::Index j = 0; j + 1 < used; ++j) {
      const Eigen::Index other = active[static_cast<std::size_t>(j + 1)];
      edges.col(j) = corners[static_cast<std::size_t>(other)] - corners[static_cast<std::size_t>(first)];
      for (Eigen::Index a = 0; a <= count; ++a) mixed.col(j).segment(Dim * a, Dim) = -share[a] * edges.col(j);
      mixed.col(j).segment(Dim * (1 + other), Dim) -= from;
      mixed.col(j).segment(Dim * (1 + first), Dim) += from;
    }
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Dim, Dim> along =
        (edges.transpose() * edges).inverse();
    second -= mixed * along * mixed.transpose();
  }
  const double push = stiffness * touch.overlap / touch.distance;
  return (stiffness + push) * slope * slope.transpose() - push * second;
}

template ContactMatrix<2> contact_tangent<2>(const Touch<2>&, std::span<const Vector<2>>, double);
template ContactMatrix<3> contact_tangent<3>(const Touch<3>&, std::span<const Vector<3>>, double);
} // namespace pdx::couple
