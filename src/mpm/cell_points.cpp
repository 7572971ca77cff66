#include "pdx/mpm/cell_points.hpp"

#include "pdx/base/symmetric.hpp"

#include <algorithm>

namespace pdx::mpm {
namespace {
constexpr double kNone = 1e-6; // of the largest stiffness of a cell

template <int Dim> bool has_all_modes(const CellMatrix<Dim>& stiffness)
{
  constexpr Eigen::Index rigid = Dim * (Dim + 1) / 2;
  const Eigen::VectorXd k = symmetric_eigenvalues(stiffness);
  return k[rigid] > kNone * k[k.size() - 1];
}

template <int Dim> law::Gradient<Dim, double>& raw(const Tensor<Dim>& h, law::Gradient<Dim, double>& to)
{
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) to[i][j] = h(i, j);
  return to;
}

template <int Dim, class Visit> auto with_law(const BodyMaterial& body, Visit&& visit)
{
  return body.law == Law::corotational ? visit(law::Corotational<Dim>(body.elastic))
                                       : visit(law::NeoHooke<Dim>(body.elastic));
}
} // namespace

template <int Dim>
CellPoints<Dim>::CellPoints(const BodyMaterial& body, std::uint64_t m) : mask(m), volume(point_volume<Dim>(body))
{
  const double h = body.side();
  for_each_point(mask, [&](int site) {
    const Vector<Dim> place = site_place<Dim>(body.ratio, site);
    sites.push_back(site);
    values.push_back(hat_values<Dim>(place));
    shares += volume * values.back();
    gradients.push_back(hat_gradients<Dim>(place, h));
  });
  held = !has_all_modes<Dim>(cell_tangent<Dim>(body, *this, CellVector<Dim>::Zero()));
  if (!held) return;
  const double part = static_cast<double>(sites.size()) / std::popcount(full_mask<Dim>(body.ratio));
  const double bending = part * body.elastic.young * (Dim == 2 ? body.elastic.thickness / 12.0 : h / 48.0);
  hourglass.fill(bending);
  if (Dim == 3) hourglass.back() = bending / 3.0;
}

template <int Dim> law::Tangent<Dim> law_tangent(const BodyMaterial& body, const Tensor<Dim>& h)
{
  return with_law<Dim>(body, [&](const auto& law) { return law.tangent(h); });
}
template <int Dim> double law_energy(const BodyMaterial& body, const Tensor<Dim>& h)
{
  law::Gradient<Dim, double> from;
  return with_law<Dim>(body, [&](const auto& law) { return law.energy(raw<Dim>(h, from)); });
}
template <int Dim> Tensor<Dim> law_stress(const BodyMaterial& body, const Tensor<Dim>& h)
{
  law::Gradient<Dim, double> from, p;
  with_law<Dim>(body, [&](const auto& law) { law.stress(raw<Dim>(h, from), p); });
  Tensor<Dim> stress;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) stress(i, j) = p[i][j];
  return stress;
}

template <int Dim>
CellMatrix<Dim> cell_tangent(const BodyMaterial& body, const CellPoints<Dim>& points, const CellVector<Dim>& u)
{
  constexpr int n = kCorners<Dim> * Dim;
  CellMatrix<Dim> k = CellMatrix<Dim>::Zero();
  Eigen::Matrix<double, Dim * Dim, n> b = Eigen::Matrix<double, Dim * Dim, n>::Zero(); // of F_iJ at i * Dim + J
  for (std::size_t p = 0; p < points.sites.size(); ++p) {
    for (int a = 0; a < kCorners<Dim>; ++a)
      for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) b(i * Dim + j, a * Dim + i) = points.gradients[p](a, j);
    const Eigen::Matrix<double, Dim * Dim, n> stress =
        points.volume * law_tangent<Dim>(body, point_gradient<Dim>(points, p, u)) * b;
    k.noalias() += b.transpose() * stress;
  }
  for (int mode = 0; points.held && mode < kHourglasses<Dim>; ++mode)
    for (int a = 0; a < kCorners<Dim>; ++a)
      for (int c = 0; c < kCorners<Dim>; ++c)
        k.template block<Dim, Dim>(a * Dim, c * Dim).diagonal().array() +=
            points.hourglass[static_cast<std::size_t>(mode)] * hourglass_sign(mode, a) * hourglass_sign(mode, c);
  return k;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template struct CellPoints<Dim>;                                                                                     \
  template law::Tangent<Dim> law_tangent<Dim>(const BodyMaterial&, const Tensor<Dim>&);                                \
  template double law_energy<Dim>(const BodyMaterial&, const Tensor<Dim>&);                                            \
  template Tensor<Dim> law_stress<Dim>(const BodyMaterial&, const Tensor<Dim>&);                                       \
  template CellMatrix<Dim> cell_tangent<Dim>(const BodyMaterial&, const CellPoints<Dim>&, const CellVector<Dim>&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
