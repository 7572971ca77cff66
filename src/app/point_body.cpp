#include "pdx/app/point_body.hpp"

#include "pdx/base/fingerprint.hpp"
#include "pdx/couple/contact_books.hpp"

#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pdx::app {
namespace {
constexpr const char* kDirections[] = {"x", "y", "z"};

template <int Dim> std::vector<mpm::BodyMaterial> materials_of(const PointPlan<Dim>& plan)
{
  std::vector<mpm::BodyMaterial> materials;
  for (const mpm::Body<Dim>& body : plan.bodies) materials.push_back(body.material);
  return materials;
}

template <int Dim> void add_points(const PointPlan<Dim>& plan, double viscosity, PointBody<Dim>& body)
{
  std::vector<mpm::PointCell<Dim>> cells;
  for (const auto& cell : std::span(body.grid.cells).first(body.grid.owned))
    cells.push_back({cell.body, cell.rows, plan.bodies[static_cast<std::size_t>(cell.body)].points_in(cell.at)});
  auto term = std::make_unique<mpm::PointTerm<Dim>>(body.system.rows, std::move(cells), materials_of(plan), viscosity);
  body.term = term.get();
  body.system.terms.push_back(std::move(term));
}

template <int Dim> Vector<Dim> turned(const Vector<3>& spin, const Vector<Dim>& arm)
{
  Vector<3> x = Vector<3>::Zero();
  x.head<Dim>() = arm;
  return spin.cross(x).template head<Dim>();
}

} // namespace

template <int Dim> void throw_bodies(const SceneOptions& options, PointBody<Dim>& body)
{
  double whole = 0.0;
  bool moves = false;
  for (std::size_t b = 0; b < body.plan.bodies.size(); ++b) {
    const PointBodyOptions& given = options.points.bodies[b];
    const mpm::Body<Dim>& of = body.plan.bodies[b];
    const double volume = std::pow(given.spacing, Dim) * (Dim == 2 ? given.elastic.thickness : 1.0);
    const double mass = given.elastic.density * volume * static_cast<double>(of.count());
    body.centre.push_back(of.centre());
    body.velocity.push_back(given.velocity.head<Dim>());
    body.spin.push_back(given.spin);
    body.momentum.push_back(mass * body.velocity.back());
    body.middle += mass * body.centre.back();
    whole += mass;
    moves = moves || !given.velocity.isZero(0.0) || !given.spin.isZero(0.0);
  }
  body.middle /= whole;
  if (!moves) return;
  for (std::size_t row = 0; row < body.grid.place.size(); ++row) {
    const auto b = static_cast<std::size_t>(body.grid.body[row]);
    const Vector<Dim> v = body.velocity[b] + turned<Dim>(body.spin[b], body.grid.place[row] - body.centre[b]);
    body.system.initial_velocity.insert(body.system.initial_velocity.end(), v.begin(), v.end());
  }
}

template <int Dim> std::string described(const PointPlan<Dim>& plan)
{
  Fingerprint fingerprint;
  for (const mpm::Body<Dim>& body : plan.bodies) {
    fingerprint.add(std::span<const double>(body.corner.data(), Dim));
    fingerprint.add(std::span<const Index>(body.cells));
    for (const std::uint64_t points : body.points) {
      const Index halves[] = {static_cast<Index>(points & 0xffffffffU), static_cast<Index>(points >> 32U)};
      fingerprint.add(std::span<const Index>(halves));
    }
  }
  return fmt::format("{} points {:016x}", plan.count(), fingerprint.value());
}
template <int Dim>
std::unique_ptr<PointBody<Dim>> discretise(const SceneOptions& options, const PointPlan<Dim>& plan,
                                           const mesh::Mesh& mesh)
{
  auto body = std::make_unique<PointBody<Dim>>(plan, mesh);
  body->body = mesh.bounds();
  body->points = plan.count();
  body->description = described(plan);
  body->node_names = body->grid.names;
  body->system.rows = body->grid.rows;
  for (const Vector<Dim>& x : body->grid.place)
    body->system.coordinates.insert(body->system.coordinates.end(), x.begin(), x.end());
  add_points(plan, options.points.viscosity, *body);
  throw_bodies(options, *body);
  add_contact(options, *body);
  apply_conditions(options, *body);
  body->system.bind();
  body->mass.assign(static_cast<std::size_t>(body->system.rows.owned()), 0.0);
  body->term->add_mass(body->mass);
  return body;
}

template <int Dim> post::Energies PointBody<Dim>::energies(std::span<const double> local) const
{
  post::Energies mine;
  mine.points = term->energy(local);
  if (contact) mine.contact = contact->energy(local);
  if (books) mine.friction = books->dissipated();
  return mine;
}

template <int Dim> std::vector<double> PointBody<Dim>::rank_sums() const
{
  return books ? books->sums() : std::vector<double>{};
}

template <int Dim> void PointBody<Dim>::resume_sums(std::span<const double> sums) const
{
  if (books) books->resume(sums);
}

/// Sums over nodes, of all ranks.
template <int Dim> struct PointBody<Dim>::Sums {
  std::vector<double> mass;              ///< of each body [kg]
  std::vector<Vector<Dim>> momentum;     ///< likewise [kg m/s]
  Vector<3> angular = Vector<3>::Zero(); ///< about `middle` [kg m^2/s]
};

template <int Dim> auto PointBody<Dim>::sums(std::span<const double> local, std::span<const double> v) const -> Sums
{
  const std::size_t bodies = plan.bodies.size();
  std::vector<double> all(bodies * (Dim + 1) + 3, 0.0);
  for (std::size_t row = 0; row < mass.size(); ++row) {
    Vector<3> arm = Vector<3>::Zero(), p = Vector<3>::Zero();
    const auto b = static_cast<std::size_t>(grid.body[row]);
    all[b * (Dim + 1)] += mass[row];
    for (std::size_t d = 0; d < Dim; ++d) {
      const auto a = static_cast<Eigen::Index>(d);
      arm[a] = grid.place[row][a] + local[Dim * row + d] - middle[a];
      p[a] = mass[row] * v[Dim * row + d];
      all[b * (Dim + 1) + 1 + d] += p[a];
    }
    const Vector<3> angular = arm.cross(p);
    for (std::size_t d = 0; d < 3; ++d) all[bodies * (Dim + 1) + d] += angular[static_cast<Eigen::Index>(d)];
  }
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_SUM, system.rows.comm);
  Sums sums;
  for (std::size_t b = 0; b < bodies; ++b) {
    sums.mass.push_back(all[b * (Dim + 1)]);
    sums.momentum.push_back(Eigen::Map<const Vector<Dim>>(&all[b * (Dim + 1) + 1]));
  }
  sums.angular = Eigen::Map<const Vector<3>>(&all[bodies * (Dim + 1)]);
  return sums;
}

template <int Dim> std::vector<io::Column> PointBody<Dim>::more_columns() const
{
  std::vector<io::Column> columns;
  for (std::size_t d = 0; d < Dim; ++d) columns.push_back({fmt::format("momentum_{}", kDirections[d]), "kg m/s"});
  for (std::size_t d = Dim == 2 ? 2 : 0; d < 3; ++d)
    columns.push_back({fmt::format("angular_momentum_{}", kDirections[d]), "kg m^2/s"});
  for (const mpm::Body<Dim>& of : plan.bodies)
    for (std::size_t d = 0; d < Dim; ++d)
      columns.push_back({fmt::format("velocity_{}_{}", of.name, kDirections[d]), "m/s"});
  if (!books) return columns;
  for (const couple::ContactBooks::Pair& pair : books->pairs())
    for (const auto& [what, unit] : {std::pair{"force", "N"}, std::pair{"impulse", "N s"}})
      for (std::size_t d = 0; d < Dim; ++d)
        columns.push_back({fmt::format("contact_{}_{}_{}_{}", pair.first, pair.second, what, kDirections[d]), unit});
  return columns;
}

template <int Dim>
void PointBody<Dim>::add_more(std::span<const double> local, std::span<const double> v, std::vector<double>& row) const
{
  const Sums now = sums(local, v);
  Vector<Dim> whole = Vector<Dim>::Zero();
  for (const Vector<Dim>& p : now.momentum) whole += p;
  row.insert(row.end(), whole.begin(), whole.end());
  row.insert(row.end(), now.angular.begin() + (Dim == 2 ? 2 : 0), now.angular.end());
  for (std::size_t b = 0; b < now.mass.size(); ++b) {
    const Vector<Dim> mean = now.momentum[b] / now.mass[b];
    row.insert(row.end(), mean.begin(), mean.end());
  }
  if (!books) return;
  std::vector<double> pushes;
  for (std::size_t pair = 0; pair < books->pairs().size(); ++pair)
    for (const std::array<double, 3>& push : {books->force(pair), books->impulse(pair)})
      pushes.insert(pushes.end(), push.begin(), push.begin() + Dim);
  MPI_Allreduce(MPI_IN_PLACE, pushes.data(), static_cast<int>(pushes.size()), MPI_DOUBLE, MPI_SUM, system.rows.comm);
  row.insert(row.end(), pushes.begin(), pushes.end());
}

template <int Dim>
void PointBody<Dim>::add_results(std::span<const double> local, std::span<const double> v,
                                 nlohmann::ordered_json& results) const
{
  const Sums now = sums(local, v);
  results["material_points"] = points;
  const bool free = system.prescribed.components.empty() && system.drives.empty();
  double thrown = 0.0;
  Vector<Dim> change = Vector<Dim>::Zero();
  for (std::size_t b = 0; b < momentum.size(); ++b) {
    thrown += momentum[b].norm();
    change += now.momentum[b] - momentum[b];
  }
  if (free && thrown > 0.0) results["momentum_error_ratio"] = change.norm() / thrown;
  if (momentum.size() != 2 || velocity[0] == velocity[1]) return;
  const Vector<Dim> before = velocity[0] - velocity[1],
                    after = now.momentum[0] / now.mass[0] - now.momentum[1] / now.mass[1];
  results["rebound_ratio"] = -after.dot(before) / before.squaredNorm();
}

namespace {
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
    field::OutputField f{fmt::format("deformation_{} [-]", kDirections[i]), field::Rank::vector, false, false, {}};
    for (std::size_t k = 0; k < deformation.size(); k += Dim * Dim)
      for (std::size_t j = 0; j < 3; ++j) f.values.push_back(entry<Dim>(&deformation[k], i, j, 0.0));
    block.fields.push_back(std::move(f));
  }
}
} // namespace

template <int Dim>
field::OutputBlock PointBody<Dim>::block(std::span<const double> local, std::span<const double> v) const
{
  field::OutputBlock block;
  block.name = "points";
  std::vector<std::vector<int>> before; // points of a body in cells before each
  int first = 0;
  for (const mpm::Body<Dim>& of : plan.bodies) {
    before.emplace_back();
    for (const std::uint64_t bits : of.points) {
      before.back().push_back(first);
      first += std::popcount(bits);
    }
  }
  field::OutputField bodies{"body", field::Rank::scalar, false, true, {}},
      owner{"rank", field::Rank::scalar, false, true, {}};
  int rank = 0;
  MPI_Comm_rank(system.rows.comm, &rank);
  for (const auto& cell : std::span(grid.cells).first(grid.owned)) {
    const auto b = static_cast<std::size_t>(cell.body);
    const mpm::Body<Dim>& of = plan.bodies[b];
    int number = before[b][static_cast<std::size_t>(of.number(cell.at))];
    mpm::for_each_point(of.points_in(cell.at), [&](int site) {
      const Vector<Dim> x = of.place(cell.at, site);
      for (int d = 0; d < 3; ++d) block.points.push_back(d < Dim ? x[std::min(d, Dim - 1)] : 0.0);
      block.natural_point.push_back(number++);
      bodies.values.push_back(cell.body + 1.0);
      owner.values.push_back(rank);
    });
  }
  block.fields.push_back(vectors_of<Dim>("displacement [m]", term->interpolated(local)));
  block.fields.push_back(vectors_of<Dim>("velocity [m/s]", term->interpolated(v)));
  block.fields.push_back(stress_of_points<Dim>(term->cauchy_stress(local)));
  push_deformation<Dim>(term->deformation(local), block);
  block.fields.push_back(std::move(bodies));
  block.fields.push_back(std::move(owner));
  return block;
}

std::vector<field::OutputBlock> PointModel::blocks(Vec u, std::span<const double> velocity) const
{
  std::vector<double> local, all;
  system.halo->gather(u, local);
  system.halo->fetch(velocity, system.rows.dim, all);
  return {block(local, all)};
}

template struct PointBody<2>;
template struct PointBody<3>;
template void throw_bodies<2>(const SceneOptions&, PointBody<2>&);
template void throw_bodies<3>(const SceneOptions&, PointBody<3>&);
template std::string described<2>(const PointPlan<2>&);
template std::string described<3>(const PointPlan<3>&);
template std::unique_ptr<PointBody<2>> discretise<2>(const SceneOptions&, const PointPlan<2>&, const mesh::Mesh&);
template std::unique_ptr<PointBody<3>> discretise<3>(const SceneOptions&, const PointPlan<3>&, const mesh::Mesh&);
} // namespace pdx::app
