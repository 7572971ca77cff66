#include "pdx/scene/point_output.hpp"

#include <bit>
#include <fmt/format.h>

namespace pdx::scene {
namespace point_fields {
constexpr const char* kRowsOf[] = {"x", "y", "z"};

template <int Dim> field::OutputField vectors_of(const char* name, const std::vector<double>& values)
{
  field::OutputField f{name, field::Rank::vector, false, false, {}};
  for (std::size_t k = 0; k < values.size(); k += Dim)
    for (std::size_t d = 0; d < 3; ++d) f.values.push_back(d < Dim ? values[k + d] : 0.0);
  return f;
}

template <int Dim> double entry(const double* tensor, std::size_t i, std::size_t j, double missing)
{
  return i < Dim && j < Dim ? tensor[Dim * i + j] : missing;
}

template <int Dim> field::OutputField stress_of_points(const std::vector<double>& stress)
{
  static constexpr std::size_t kPairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  field::OutputField f{"stress [Pa]", field::Rank::tensor, false, false, {}};
  for (std::size_t k = 0; k < stress.size(); k += Dim * Dim)
    for (const auto& [i, j] : kPairs) f.values.push_back(entry<Dim>(&stress[k], i, j, 0.0));
  return f;
}

/// Rows of the deformation gradient, as vectors.
template <int Dim> void push_deformation(const std::vector<double>& deformation, field::OutputBlock& block)
{
  for (std::size_t i = 0; i < Dim; ++i) {
    field::OutputField f{fmt::format("deformation_{} [-]", kRowsOf[i]), field::Rank::vector, false, false, {}};
    for (std::size_t k = 0; k < deformation.size(); k += Dim * Dim)
      for (std::size_t j = 0; j < 3; ++j) f.values.push_back(entry<Dim>(&deformation[k], i, j, 0.0));
    block.fields.push_back(std::move(f));
  }
}
} // namespace point_fields

template <int Dim> void add_point_fields(const PointFields& fields, int rank, field::OutputBlock& block)
{
  using namespace point_fields;
  field::OutputField bodies{"body", field::Rank::scalar, false, true, {}},
      owner{"rank", field::Rank::scalar, false, true, {}};
  for (const Index body : fields.body) bodies.values.push_back(body + 1.0);
  owner.values.assign(fields.body.size(), rank);
  block.fields.push_back(vectors_of<Dim>("displacement [m]", fields.displacement));
  block.fields.push_back(vectors_of<Dim>("velocity [m/s]", fields.velocity));
  block.fields.push_back(stress_of_points<Dim>(fields.stress));
  push_deformation<Dim>(fields.deformation, block);
  block.fields.push_back(std::move(bodies));
  block.fields.push_back(std::move(owner));
}

template <int Dim>
field::OutputBlock point_block(const PointPlan<Dim>& plan, std::span<const CellOfBody<Dim>> cells,
                               const mpm::PointTerm<Dim>& term, std::span<const double> local,
                               std::span<const double> velocity, int rank,
                               const std::function<bool(const CellOfBody<Dim>&)>& is_there)
{
  PointFields fields{
      term.interpolated(local), term.interpolated(velocity), term.cauchy_stress(local), term.deformation(local), {}};
  field::OutputBlock block;
  block.name = "points";
  std::vector<std::vector<int>> before; // points of a body in cells before each
  int first = 0;
  for (std::size_t b = 0; b < plan.bodies.size(); ++b) {
    const mpm::Body<Dim>& of = plan.bodies[b];
    before.emplace_back();
    for (std::size_t k = 0; k < of.points.size(); ++k) {
      before.back().push_back(first);
      if (of.points[k] && is_there({static_cast<Index>(b), of.cell(static_cast<std::int64_t>(k))}))
        first += std::popcount(of.points[k]);
    }
  }
  for (const CellOfBody<Dim>& cell : cells) {
    const auto b = static_cast<std::size_t>(cell.body);
    const mpm::Body<Dim>& of = plan.bodies[b];
    int number = before[b][static_cast<std::size_t>(of.number(cell.at))];
    mpm::for_each_point(of.points_in(cell.at), [&](int site) {
      const Vector<Dim> x = of.place(cell.at, site);
      for (int d = 0; d < 3; ++d) block.points.push_back(d < Dim ? x[std::min(d, Dim - 1)] : 0.0);
      block.natural_point.push_back(number++);
      fields.body.push_back(cell.body);
    });
  }
  add_point_fields<Dim>(fields, rank, block);
  return block;
}

template void add_point_fields<2>(const PointFields&, int, field::OutputBlock&);
template void add_point_fields<3>(const PointFields&, int, field::OutputBlock&);
template field::OutputBlock point_block<2>(const PointPlan<2>&, std::span<const CellOfBody<2>>,
                                           const mpm::PointTerm<2>&, std::span<const double>, std::span<const double>,
                                           int, const std::function<bool(const CellOfBody<2>&)>&);
template field::OutputBlock point_block<3>(const PointPlan<3>&, std::span<const CellOfBody<3>>,
                                           const mpm::PointTerm<3>&, std::span<const double>, std::span<const double>,
                                           int, const std::function<bool(const CellOfBody<3>&)>&);
} // namespace pdx::scene
