#include "pdx/mpm/point_term.hpp"

#include <Eigen/LU>

namespace pdx::mpm {
template <int Dim> template <class Visit> void PointTerm<Dim>::for_each_own(Visit&& visit) const
{
  std::size_t first = 0;
  for (std::size_t k = 0; k < cells_.size(); ++k) {
    const CellPoints<Dim>& points = patterns_.at(cells_[k].body, cells_[k].points);
    visit(k, points, first);
    first += points.sites.size();
  }
}

template <int Dim> std::vector<Index> PointTerm<Dim>::bodies() const
{
  std::vector<Index> all;
  for (const PointCell<Dim>& cell : cells_)
    all.insert(all.end(), static_cast<std::size_t>(std::popcount(cell.points)), cell.body);
  return all;
}

template <int Dim> std::vector<double> PointTerm<Dim>::masses() const
{
  std::vector<double> all;
  for (const PointCell<Dim>& cell : cells_)
    all.insert(all.end(), static_cast<std::size_t>(std::popcount(cell.points)),
               material(cell.body).elastic.density * point_volume<Dim>(material(cell.body)));
  return all;
}

template <int Dim> std::vector<double> PointTerm<Dim>::interpolated(std::span<const double> values) const
{
  std::vector<double> all(static_cast<std::size_t>(points_) * Dim, 0.0);
  for_each_own([&](std::size_t k, const CellPoints<Dim>& points, std::size_t first) {
    for (std::size_t p = 0; p < points.sites.size(); ++p)
      for (std::size_t a = 0; a < local_[k].rows.size(); ++a)
        for (std::size_t d = 0; d < Dim; ++d)
          all[(first + p) * Dim + d] += points.values[p][static_cast<Eigen::Index>(a)] *
                                        values[static_cast<std::size_t>(local_[k].rows[a]) * Dim + d];
  });
  return all;
}

template <int Dim> std::vector<double> PointTerm<Dim>::positions(std::span<const Vector<Dim>> corners) const
{
  std::vector<double> all(static_cast<std::size_t>(points_) * Dim);
  for_each_own([&](std::size_t k, const CellPoints<Dim>& points, std::size_t first) {
    const BodyMaterial& body = material(cells_[k].body);
    for (std::size_t p = 0; p < points.sites.size(); ++p)
      Eigen::Map<Vector<Dim>>(all.data() + (first + p) * Dim) =
          corners[k] + body.side() * site_place<Dim>(body.ratio, points.sites[p]);
  });
  return all;
}

template <int Dim>
template <class Visit>
std::vector<double> PointTerm<Dim>::of_gradients(std::span<const double> u, Visit&& visit) const
{
  std::vector<double> all(static_cast<std::size_t>(points_) * Dim * Dim);
  for_each_own([&](std::size_t k, const CellPoints<Dim>& points, std::size_t first) {
    const CellVector<Dim> corners = corner_values<Dim>(local_[k], u);
    for (std::size_t p = 0; p < points.sites.size(); ++p) {
      const Tensor<Dim> value = visit(material(cells_[k].body), point_gradient<Dim>(points, p, corners));
      for (int i = 0; i < Dim * Dim; ++i)
        all[(first + p) * Dim * Dim + static_cast<std::size_t>(i)] = value(i / Dim, i % Dim);
    }
  });
  return all;
}

template <int Dim> std::vector<double> PointTerm<Dim>::deformation(std::span<const double> u) const
{
  return of_gradients(
      u, [](const BodyMaterial&, const Tensor<Dim>& h) -> Tensor<Dim> { return Tensor<Dim>::Identity() + h; });
}

template <int Dim> std::vector<double> PointTerm<Dim>::cauchy_stress(std::span<const double> u) const
{
  return of_gradients(u, [](const BodyMaterial& body, const Tensor<Dim>& h) -> Tensor<Dim> {
    const Tensor<Dim> f = Tensor<Dim>::Identity() + h;
    return law_stress<Dim>(body, h) * f.transpose() / f.determinant();
  });
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template std::vector<Index> PointTerm<Dim>::bodies() const;                                                          \
  template std::vector<double> PointTerm<Dim>::masses() const;                                                         \
  template std::vector<double> PointTerm<Dim>::interpolated(std::span<const double>) const;                            \
  template std::vector<double> PointTerm<Dim>::positions(std::span<const Vector<Dim>>) const;                          \
  template std::vector<double> PointTerm<Dim>::deformation(std::span<const double>) const;                             \
  template std::vector<double> PointTerm<Dim>::cauchy_stress(std::span<const double>) const
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
