#include "grid_body.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/stop_signals.hpp"
#include "pdx/mesh/gmsh.hpp"
#include "pdx/scene/thrown_bodies.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pdx::scene {
namespace {
/// Mass and strain energy of points, for what asks the Terms of a System.
template <int Dim> class GridTerm final : public field::Term {
public:
  explicit GridTerm(const GridBody<Dim>& body) : body_(body) {}
  void needed_rows(std::vector<PetscInt>&) const override {}
  void bind(const field::RowHalo&) override {}
  void add_residual(std::span<const double>, std::span<double>) const override {}
  double energy(std::span<const double>) const override { return body_.motion->energies().strain; }
  void couplings(field::Couplings&, bool) const override {}
  void add_jacobian(field::BlockAdder&, bool) const override {}
  void add_mass(std::span<double> mass) const override
  {
    for (std::size_t row = 0; row < mass.size(); ++row) {
      const mpm::BodyMaterial& of = body_.materials[static_cast<std::size_t>(body_.grid.body[row])];
      mass[row] += of.elastic.density * mpm::point_volume<Dim>(of);
    }
  }

private:
  const GridBody<Dim>& body_;
};

template <int Dim> class GridSteps final : public field::OwnSteps {
public:
  explicit GridSteps(const GridBody<Dim>& body) : body_(body), motion_(*body.motion) {}
  void step(double from, double to, bool first) override
  {
    std::vector<Vector<Dim>> on(body_.materials.size(), Vector<Dim>::Zero());
    for (const GridPush& push : body_.pushes)
      on[push.body] += push.history.value(from) * push.force.template head<Dim>();
    for (std::size_t b = 0; b < on.size(); ++b) motion_.set_push(b, on[b]);
    motion_.step(from, to - from, first ? 0.5 * (to - from) : to - from);
  }
  void tell(double length, std::span<double> u, std::span<double> v) const override
  {
    for_each_row(motion_.ended(0.5 * length), [&](std::size_t row, const double* numbers) {
      for (std::size_t d = 0; d < Dim; ++d) {
        const auto a = static_cast<Eigen::Index>(d);
        u[Dim * row + d] = body_.origin[a] + motion_.rule().side * numbers[d * kLanes] - body_.grid.place[row][a];
        v[Dim * row + d] = numbers[(Dim + d) * kLanes];
      }
    });
  }
  double work() const override { return motion_.work(); }
  int width() const override { return kNumbers; }
  void inner(std::vector<double>& all) const override
  {
    all.resize(body_.grid.place.size() * kNumbers);
    for (std::size_t b = 0; b < body_.materials.size(); ++b)
      motion_.lanes(b).for_each([&](Index id, const double* numbers) {
        double* to = all.data() + static_cast<std::size_t>(body_.first[b] + id) * kNumbers;
        for (std::size_t n = 0; n < kNumbers; ++n) to[n] = numbers[n * kLanes];
      });
  }
  void resume(double time, std::span<const double> inner, double work) override
  {
    std::vector<std::vector<mpm::GridPoint<Dim>>> points(body_.materials.size());
    for (std::size_t row = 0; row < body_.grid.place.size(); ++row) {
      auto& of_body = points[static_cast<std::size_t>(body_.grid.body[row])];
      mpm::GridPoint<Dim> p;
      const double* from = inner.data() + row * kNumbers;
      p.id = static_cast<Index>(of_body.size());
      for (int d = 0; d < Dim; ++d) p.at[d] = *from++;
      for (int d = 0; d < Dim; ++d) p.v[d] = *from++;
      for (int d = 0; d < Dim * Dim; ++d) p.h(d / Dim, d % Dim) = *from++;
      of_body.push_back(p);
    }
    motion_.resume(std::move(points), work, time);
  }

private:
  static constexpr std::size_t kLanes = mpm::PointLanes<Dim>::kLanes, kNumbers = mpm::PointLanes<Dim>::kNumbers;
  template <class Visit> void for_each_row(const std::vector<mpm::PointLanes<Dim>>& points, Visit&& visit) const
  {
    for (std::size_t b = 0; b < points.size(); ++b)
      points[b].for_each(
          [&](Index id, const double* numbers) { visit(static_cast<std::size_t>(body_.first[b] + id), numbers); });
  }
  const GridBody<Dim>& body_;
  mpm::GridMotion<Dim>& motion_;
};

template <int Dim> double wave_speed(const mpm::BodyMaterial& body)
{
  return std::sqrt(mpm::law_tangent<Dim>(body, Tensor<Dim>::Zero())(0, 0) / body.elastic.density);
}
} // namespace

/// Rows are points: body by body, in order of the mesh's cells and of their sites.
template <int Dim> std::vector<std::vector<mpm::GridPoint<Dim>>> GridBody<Dim>::lay_points(double side)
{
  PointRows<Dim>& rows = this->grid;
  const std::vector<typename PointRows<Dim>::Cell> cells(rows.cells.begin(),
                                                         rows.cells.begin() + static_cast<std::ptrdiff_t>(rows.owned));
  rows.body.clear();
  rows.place.clear();
  rows.names.clear();
  std::vector<std::vector<mpm::GridPoint<Dim>>> laid(this->plan.bodies.size());
  int before = 0; // points of bodies before
  for (std::size_t b = 0; b < laid.size(); ++b) {
    const mpm::Body<Dim>& of = this->plan.bodies[b];
    std::vector<int> number{before};
    for (const std::uint64_t bits : of.points) number.push_back(number.back() + std::popcount(bits));
    before = number.back();
    first.push_back(static_cast<Index>(rows.place.size()));
    for (const auto& cell : cells) {
      if (static_cast<std::size_t>(cell.body) != b) continue;
      int natural = number[static_cast<std::size_t>(of.number(cell.at))];
      mpm::for_each_point(of.points_in(cell.at), [&](int site) {
        mpm::GridPoint<Dim> p;
        const Vector<Dim> x = of.place(cell.at, site);
        p.id = static_cast<Index>(laid[b].size());
        p.at = (x - origin) / side;
        laid[b].push_back(p);
        rows.body.push_back(cell.body);
        rows.place.push_back(x);
        rows.names.push_back(field::RowName::node(natural));
        natural_.push_back(natural++);
      });
    }
  }
  rows.rows = field::Rows::number(this->mesh.comm(), Dim, static_cast<Index>(rows.place.size()), 0, 0);
  return laid;
}

template <int Dim>
GridBody<Dim>::GridBody(const options::SceneOptions& options, const PointPlan<Dim>& filled,
                        const mesh::Mesh& background, Model& scene)
    : PointBody<Dim>(filled, background, scene)
{
  field::System& system = scene.system;
  materials = filled.materials();
  double coarsest = 0.0;
  for (const mpm::Body<Dim>& of : filled.bodies) coarsest = std::max(coarsest, of.cell_size());
  mpm::GridRule rule = options.points.grid;
  rule.side = coarsest;
  origin = filled.bodies[0].corner;
  limit_ = std::numeric_limits<double>::infinity();
  for (const mpm::BodyMaterial& of : materials) limit_ = std::min(limit_, rule.side / wave_speed<Dim>(of));
  scene.body = background.bounds();
  scene.material_points = filled.count();
  auto points_of = lay_points(rule.side);
  system.rows = this->grid.rows;
  for (const Vector<Dim>& x : this->grid.place) system.coordinates.insert(system.coordinates.end(), x.begin(), x.end());
  throw_bodies<Dim>(options.points, filled, this->grid.body, system);
  std::vector<double>& v = system.initial_velocity;
  v.resize(this->grid.place.size() * Dim, 0.0);
  throw_points(options, *this);
  std::size_t row = 0;
  for (auto& of_body : points_of)
    for (mpm::GridPoint<Dim>& p : of_body)
      for (std::size_t d = 0; d < Dim; ++d) p.v[static_cast<Eigen::Index>(d)] = v[row++];
  try {
    motion = std::make_unique<mpm::GridMotion<Dim>>(background.comm(), rule, origin, materials, std::move(points_of));
  } catch (const SolverFailure& failure) {
    throw UserError(fmt::format("-mpm_bodies: {}, with cells {:g} m wide: put the bodies nearer to each other, or give "
                                "-mpm_formulation total",
                                failure.what(), rule.side));
  }
  apply_conditions<Dim>(options, *this);
  system.terms.push_back(std::make_unique<GridTerm<Dim>>(*this));
  system.steps = std::make_unique<GridSteps<Dim>>(*this);
  system.bind();
  scene.bodies = std::make_unique<BodyBooks<Dim>>(system, this->rows_of_bodies(), nullptr);
}

template <int Dim> void GridBody<Dim>::add_energies(std::span<const double>, post::Energies& mine) const
{
  mine.points += motion->energies().strain;
}

template <int Dim> void GridBody<Dim>::add_columns(std::vector<io::Column>& columns) const
{
  PointBody<Dim>::add_columns(columns);
  for (const HeldColumn& held : holds) columns.push_back({held.name, "N"});
}

template <int Dim>
void GridBody<Dim>::add_row(std::span<const double> local, std::span<const double> v, std::vector<double>& row) const
{
  PointBody<Dim>::add_row(local, v, row);
  std::vector<double> forces(motion->hold_force().begin(), motion->hold_force().end());
  forces.resize(held_places, 0.0);
  MPI_Allreduce(MPI_IN_PLACE, forces.data(), static_cast<int>(forces.size()), MPI_DOUBLE, MPI_SUM,
                this->model.system.rows.comm);
  for (const HeldColumn& held : holds) row.push_back(held.part * forces[held.hold]);
}

template <int Dim>
field::OutputBlock GridBody<Dim>::block(std::span<const double> local, std::span<const double> v) const
{
  const std::vector<Vector<Dim>>& place = this->grid.place;
  PointFields fields{{local.begin(), local.end()}, {v.begin(), v.end()}, {}, {}, this->grid.body};
  fields.stress.resize(place.size() * Dim * Dim);
  fields.deformation.resize(place.size() * Dim * Dim);
  for (std::size_t b = 0; b < materials.size(); ++b)
    motion->lanes(b).for_each([&](Index id, const double* numbers) {
      const std::size_t at = static_cast<std::size_t>(first[b] + id) * Dim * Dim;
      Tensor<Dim> strain;
      for (int n = 0; n < Dim * Dim; ++n)
        strain(n / Dim, n % Dim) = numbers[(2 * Dim + n) * mpm::PointLanes<Dim>::kLanes];
      const Tensor<Dim> f = Tensor<Dim>::Identity() + strain;
      const Tensor<Dim> stress = mpm::law_stress<Dim>(materials[b], strain) * f.transpose() / f.determinant();
      for (int n = 0; n < Dim * Dim; ++n) {
        fields.stress[at + static_cast<std::size_t>(n)] = stress(n / Dim, n % Dim);
        fields.deformation[at + static_cast<std::size_t>(n)] = f(n / Dim, n % Dim);
      }
    });
  field::OutputBlock block;
  block.name = "points";
  block.natural_point = natural_;
  for (const Vector<Dim>& x : place)
    for (Eigen::Index d = 0; d < 3; ++d) block.points.push_back(d < Dim ? x[std::min<Eigen::Index>(d, Dim - 1)] : 0.0);
  int rank = 0;
  MPI_Comm_rank(this->model.system.rows.comm, &rank);
  add_point_fields<Dim>(fields, rank, block);
  return block;
}

namespace {
template <int Dim> class GridScene final : public Scene {
public:
  GridScene(MPI_Comm comm, options::SceneOptions given, const PointPlan<Dim>& plan, const mesh::MeasuredCosts* costs)
      : options_(std::move(given)),
        mesh_(costs ? mesh::build_by_costs(comm, plan.mesh, *costs) : mesh::build(comm, plan.mesh, {}))
  {
    auto body = std::make_unique<GridBody<Dim>>(options_, plan, mesh_, model_);
    limit_ = body->limit();
    model_.parts.push_back(std::move(body));
    stop_if_told(comm);
  }
  Standing standing() override { return {&mesh_, &model_}; }
  field::System& system() override { return model_.system; }
  StepLimits limits() override { return {limit_, 0.0}; }

private:
  options::SceneOptions options_;
  mesh::Mesh mesh_;
  Model model_;
  double limit_ = 0.0; // of a step [s]
};

template <int Dim> SceneMaker grid_maker(MPI_Comm comm, options::SceneOptions& options)
{
  auto plan = std::make_shared<PointPlan<Dim>>(plan_points<Dim>(options, std::numeric_limits<double>::infinity()));
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  if (rank) *plan->mesh.list = {}; // a mesh begins on one rank
  return [comm, &options, plan](const Layout& layout, const mesh::MeasuredCosts* costs) -> std::unique_ptr<Scene> {
    return std::make_unique<GridScene<Dim>>(comm, layout.in(options), *plan, costs);
  };
}
} // namespace

SceneMaker grid_scene(MPI_Comm comm, options::SceneOptions& options)
{
  return options.solid ? grid_maker<3>(comm, options) : grid_maker<2>(comm, options);
}

template struct GridBody<2>;
template struct GridBody<3>;
} // namespace pdx::scene
