#pragma once
#include "pdx/fem/loads.hpp"
#include "pdx/post/error_norm.hpp"
#include "pdx/scene/discretisation.hpp"
#include "pdx/scene/mixed_points.hpp"
#include "pdx/solve/static_driver.hpp"

#include <cmath>
#include <functional>

namespace pdx::test {
/// A displacement [m] or a force density [N/m^3] at a point [m].
using Field = std::function<Vector<2>(const Vector<2>& x)>;

/// u = gradient x + shift.
inline Field affine(double xx, double xy, double yx, double yy, const Vector<2>& shift = Vector<2>::Zero())
{
  Tensor<2> gradient;
  gradient << xx, xy, yx, yy;
  return [gradient, shift](const Vector<2>& x) -> Vector<2> { return gradient * x + shift; };
}

/// Numbers in [-1, 1) without a pattern that depend on the place only (to 1e-7 m), hence not on the number of ranks.
inline Field noise(std::uint64_t seed)
{
  return [seed](const Vector<2>& x) {
    std::uint64_t bits = seed;
    const auto next = [&](double value) {
      bits += 0x9e3779b97f4a7c15u + static_cast<std::uint64_t>(std::llround(value * 1e7));
      bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
      bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
      bits ^= bits >> 31;
      return static_cast<double>(bits >> 11) * 0x1p-52 - 1.0;
    };
    const double first = next(x.x()), second = next(x.y());
    return Vector<2>(0.5 * (first + second), next(first));
  };
}

/// Sets an option of PETSc's database for as long as this object lives.
class Option {
public:
  Option(std::string name, const std::string& value) : name_(std::move(name))
  {
    PDX_CALL(PetscOptionsSetValue(nullptr, name_.c_str(), value.c_str()));
  }
  ~Option() { (void)PetscOptionsClearValue(nullptr, name_.c_str()); }
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;

private:
  std::string name_;
};

inline law::Elastic plane_stress() { return {3.0, 1.0 / 3.0, law::Plane::stress, 0.5}; }

/// The unit square (or another box) with all four sides held at 0; `Scene::prescribe` moves them.
inline options::SceneOptions held_plate(std::array<Index, 2> cells, const geom::Box<2>& box = {{0.0, 0.0}, {1.0, 1.0}})
{
  options::SceneOptions options;
  options.mesh.box = box;
  options.mesh.cells = cells;
  options.elastic = plane_stress();
  for (const char* side : {"left", "right", "bottom", "top"}) {
    options::BoundaryCondition c;
    c.name = c.on = side;
    c.displacement = {0.0, 0.0};
    options.conditions.push_back(c);
  }
  return options;
}

inline options::SceneOptions with_patch(options::SceneOptions options, const geom::Box<2>& patch, double dx)
{
  options.pd.patches.push_back(patch);
  options.pd.spacing.push_back(dx);
  return options;
}

/// The unit square as particles only, held in layers of one horizon all around it.
inline options::SceneOptions held_particles(Index per_side)
{
  options::SceneOptions options = held_plate({0, 0});
  options.pd.everywhere = true;
  options.pd.spacing = {1.0 / per_side};
  for (options::BoundaryCondition& c : options.conditions) c.layer = true;
  return options;
}

/// A scene as the program builds it, from options in C++. All methods are collective on `comm`.
class Scene {
public:
  explicit Scene(options::SceneOptions options, bool assembled = false, MPI_Comm comm = PETSC_COMM_WORLD)
      : options_(std::move(options)), points_(options_.mixed() ? scene::settle_mixed(comm, options_) : nullptr),
        mesh_options_(options_.mesh), plan_(scene::plan_patches(options_, mesh_options_)),
        mesh_(mesh::build(comm, mesh_options_, scene::cell_cost(plan_))), assembled_(assembled)
  {
    if (points_) scene::deal_cells(*points_, mesh_);
    std::vector<pd::Particle> particles;
    if (options_.pd.any()) {
      scene::cover_cells(mesh_, plan_, mesh_options_);
      particles = scene::make_particles(mesh_, plan_);
    }
    d_ = scene::discretise(mesh_, options_, plan_, std::move(particles), assembled, points_.get());
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const options::SceneOptions& options() const { return options_; }
  const mesh::Mesh& mesh() const { return mesh_; }
  const scene::PatchPlan& plan() const { return plan_; }
  scene::Discretisation& d() { return *d_; }
  field::System& system() { return d_->system; }
  const field::Rows& rows() const { return d_->system.rows; }

  Vector<2> place(Index row) const
  {
    const auto at = static_cast<std::size_t>(2 * row);
    return {d_->system.coordinates[at], d_->system.coordinates[at + 1]};
  }

  /// Prescribes the field wherever the conditions hold a component.
  void prescribe(const Field& field)
  {
    auto& [components, values] = d_->system.prescribed;
    for (std::size_t k = 0; k < components.size(); ++k) values[k] = field(place(components[k] / 2))[components[k] % 2];
  }

  /// Adds a body force [N/m^3]: consistent nodal forces, and volume times density at particles.
  void load(const Field& density)
  {
    field::System& system = d_->system;
    fem::add_body_force(mesh_, density, options_.elastic.thickness, {d_->node_rows, system.rows, system.load});
    for (std::size_t k = 0; k < d_->particles.size(); ++k) {
      const double volume = plan_.stencils[static_cast<std::size_t>(d_->particles[k].patch)].volume();
      const Vector<2> force = volume * density(d_->particles[k].x);
      const std::size_t at = 2 * (static_cast<std::size_t>(system.rows.first_particle()) + k);
      system.load[at] += force.x();
      system.load[at + 1] += force.y();
    }
  }

  /// The field at the rows, [owned | halo].
  std::vector<double> blocks(const Field& field) const
  {
    std::vector<double> owned, all;
    for (Index row = 0; row < d_->system.rows.owned(); ++row) {
      const Vector<2> value = field(place(row));
      owned.insert(owned.end(), {value.x(), value.y()});
    }
    d_->system.halo->fetch(owned, 2, all);
    return all;
  }

  /// The field at the owned rows as a Vec.
  VecHandle vector(const Field& field) const
  {
    VecHandle v = d_->system.rows.vector();
    const std::vector<double> values = blocks(field);
    double* to = nullptr;
    PDX_CALL(VecGetArray(v.get(), &to));
    std::copy_n(values.begin(), 2 * d_->system.rows.owned(), to);
    PDX_CALL(VecRestoreArray(v.get(), &to));
    return v;
  }

  /// Internal force of the owned rows, all Terms [N].
  std::vector<double> internal_force(std::span<const double> u) const
  {
    std::vector<double> r(static_cast<std::size_t>(2 * d_->system.rows.owned()), 0.0);
    for (const auto& term : d_->system.terms) term->add_residual(u, r);
    return r;
  }

  /// Strain energy of the whole body [J].
  double energy(std::span<const double> u) const
  {
    double total = 0.0;
    for (const auto& term : d_->system.terms) total += term->energy(u);
    return sum(total);
  }

  /// Solves from zero; the report stays with the scene.
  VecHandle solve(int load_steps = 1)
  {
    solve::StaticDriver driver(d_->system, {load_steps, assembled_});
    VecHandle u = d_->system.rows.vector();
    driver.run(u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
    report_ = driver.report();
    return u;
  }
  const solve::StaticReport& report() const { return report_; }

  /// Largest distance of a row's displacement from the field, over the field's largest value.
  double max_error(Vec u, const Field& field) const
  {
    const double* values = nullptr;
    double worst[2] = {0.0, 0.0};
    PDX_CALL(VecGetArrayRead(u, &values));
    for (Index row = 0; row < d_->system.rows.owned(); ++row) {
      const Vector<2> exact = field(place(row)), found(values[2 * row], values[2 * row + 1]);
      worst[0] = std::max(worst[0], (found - exact).norm());
      worst[1] = std::max(worst[1], exact.norm());
    }
    PDX_CALL(VecRestoreArrayRead(u, &values));
    MPI_Allreduce(MPI_IN_PLACE, worst, 2, MPI_DOUBLE, MPI_MAX, mesh_.comm());
    return worst[0] / worst[1];
  }

  /// Distance of the displacement from the field in L2 [m^2]: particles weigh their cell, nodes that of the mesh.
  double l2_error(Vec u, const Field& field) const
  {
    const double* values = nullptr;
    double total = 0.0;
    const Index first = d_->system.rows.first_particle();
    PDX_CALL(VecGetArrayRead(u, &values));
    for (Index row = 0; row < d_->system.rows.owned(); ++row) {
      double area = mesh_.bounds().size().prod() / mesh_.global_cells();
      if (row >= first) {
        const Index patch = d_->particles[static_cast<std::size_t>(row - first)].patch;
        area = std::pow(plan_.shapes[static_cast<std::size_t>(patch)].lattice.dx, 2);
      }
      total += area * (Vector<2>(values[2 * row], values[2 * row + 1]) - field(place(row))).squaredNorm();
    }
    PDX_CALL(VecRestoreArrayRead(u, &values));
    return std::sqrt(sum(total));
  }

  double sum(double mine) const
  {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_SUM, mesh_.comm());
    return mine;
  }
  double max(double mine) const
  {
    MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_DOUBLE, MPI_MAX, mesh_.comm());
    return mine;
  }

private:
  options::SceneOptions options_;
  std::shared_ptr<const scene::PointPlan<2>> points_;
  mesh::MeshOptions mesh_options_;
  scene::PatchPlan plan_;
  mesh::Mesh mesh_;
  bool assembled_;
  std::unique_ptr<scene::Discretisation> d_;
  solve::StaticReport report_;
};

/// What `value` returns on one rank alone, told to all: the same scene on PETSC_COMM_SELF of rank 0. Collective.
inline double on_one_rank(const std::function<double(MPI_Comm)>& value)
{
  int rank = 0;
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  double result = rank ? 0.0 : value(PETSC_COMM_SELF);
  MPI_Bcast(&result, 1, MPI_DOUBLE, 0, PETSC_COMM_WORLD);
  return result;
}
} // namespace pdx::test
