#include "pdx/app/scene_state.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::app {
namespace {
constexpr int kFormat = 2;                           // of the tables
constexpr const char* kArrivals = "/crack_arrivals"; // patch, site, time [s], look

/// An enriched set by what does not depend on the number of ranks.
struct SetName {
  Index vertex;
  int crack;
  auto operator<=>(const SetName&) const = default;
};

std::vector<SetName> names_of_sets(const mesh::Mesh& mesh, const Discretisation& d)
{
  std::vector<SetName> names;
  if (!d.sets) return names;
  PetscInt row = d.system.rows.first + d.system.rows.nodes;
  for (const Index v : d.sets->vertices()) {
    for (const xfem::EnrichedSet& set : d.sets->of(v))
      if (set.row == row) names.push_back({mesh.natural_vertex(v), set.crack});
    ++row;
  }
  return names;
}

std::string lines_of(const SceneOptions& options, const PatchPlan& plan)
{
  const law::Elastic& m = options.elastic;
  std::string text =
      fmt::format("material = E {} nu {} rho {} thickness {} {}\nkinematics = {}\nscheme = {}\n", m.young, m.poisson,
                  m.density, m.thickness, m.plane == law::Plane::stress ? "plane stress" : "plane strain",
                  static_cast<int>(options.kinematics), static_cast<int>(options.scheme));
  for (std::size_t p = 0; p < plan.shapes.size(); ++p) {
    const auto& lattice = plan.shapes[p].lattice;
    text +=
        fmt::format("patch {} = {} x {} particles {} m apart from ({}, {}), {} bonds\n", p + 1, lattice.count[0],
                    lattice.count[1], lattice.dx, lattice.origin[0], lattice.origin[1], plan.stencils[p].half.size());
  }
  for (std::size_t c = 0; c < options.cracks.lines.size(); ++c) {
    text += fmt::format("crack {} =", c + 1);
    for (const Vector<2>& x : options.cracks.lines[c]) text += fmt::format(" ({}, {})", x[0], x[1]);
    text += "\n";
  }
  return text;
}
} // namespace

SceneState::SceneState(const Standing& scene, const SceneOptions& options)
    : mesh_(*scene.mesh), plan_(*scene.plan), d_(*scene.d)
{
  number_rows();
  describe(options);
}

void SceneState::number_rows()
{
  const MPI_Comm comm = d_.system.rows.comm;
  const std::vector<SetName> mine = names_of_sets(mesh_, d_);
  std::vector<SetName> all = gather_all(comm, mine);
  std::ranges::sort(all);
  sets_ = static_cast<PetscInt>(all.size());
  first_.assign(1, mesh_.global_vertices() + sets_);
  for (const auto& shape : plan_.shapes) first_.push_back(first_.back() + static_cast<PetscInt>(shape.lattice.total()));

  std::vector<PetscInt> held, particles;
  for (const Index v : d_.nodes) held.push_back(mesh_.natural_vertex(v));
  for (const SetName& name : mine)
    held.push_back(mesh_.global_vertices() + static_cast<PetscInt>(std::ranges::lower_bound(all, name) - all.begin()));
  for (const pd::Particle& p : d_.particles) {
    held.push_back(first_[0] + particle_number(p.patch, p.site));
    particles.push_back(particle_number(p.patch, p.site));
  }
  rows_ = std::make_unique<io::NaturalOrder>(comm, first_.back(), held);
  particles_ = std::make_unique<io::NaturalOrder>(comm, first_.back() - first_[0], particles);
}

PetscInt SceneState::particle_number(Index patch, Index site) const
{
  return first_[static_cast<std::size_t>(patch)] - first_[0] + site;
}

void SceneState::describe(const SceneOptions& options)
{
  std::int64_t counts[2] = {d_.system.rows.nodes, d_.system.rows.particles};
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, d_.system.rows.comm);
  text_ = fmt::format("format = {}\nvertices = {}\nnodes = {}\nenriched sets = {}\nparticles = {}\n", kFormat,
                      mesh_.global_vertices(), counts[0], sets_, counts[1]);
  text_ += lines_of(options, plan_);
  text_ += fmt::format("critical stretch = {}\n", fmt::join(d_.critical_stretch, ", "));
}

void SceneState::write(io::Hdf5File& file, const solve::TimeDriver& driver) const
{
  const solve::TimeDriver::State state = driver.state();
  std::vector<double> held(state.u.size(), 0.0);
  for (std::size_t k = 0; k < state.held.size(); ++k)
    held[static_cast<std::size_t>(d_.system.prescribed.components[k])] = state.held[k];
  const auto table = [&](const std::string& name, std::span<const double> values) {
    const std::vector<double> block = rows_->to_table(values, 2);
    file.dataset(name, std::span<const double>(block), 2);
  };
  table("/displacement", state.u);
  table("/velocity", state.v);
  table("/acceleration", state.a);
  table("/held_force", held);
  if (!d_.breaker) return;

  std::vector<std::uint64_t> words;
  for (const auto& part : d_.bonds->parts())
    for (Index k = 0; k < static_cast<Index>(part->sites().size()); ++k)
      for (const std::uint64_t word : part->words_of(k)) words.push_back(word);
  const std::vector<std::uint64_t> block = particles_->to_table(words, 2);
  file.dataset("/bond_words", std::span<const std::uint64_t>(block), 2);
  if (!d_.carried) return;
  std::vector<std::uint64_t> keys = gather_all(d_.system.rows.comm, d_.carried->broken());
  std::ranges::sort(keys);
  int rank = 0;
  MPI_Comm_rank(d_.system.rows.comm, &rank);
  if (rank) keys.clear();
  file.dataset("/broken_carried_bonds", std::span<const std::uint64_t>(keys), 1);
}

std::vector<double> SceneState::read_rows(const io::Hdf5Reader& file, const std::string& name) const
{
  std::vector<double> block(2 * static_cast<std::size_t>(rows_->rows()));
  file.read(name, rows_->first(), 2, std::span<double>(block));
  return rows_->from_table(block, 2);
}

void SceneState::read_bonds(const io::Hdf5Reader& file) const
{
  std::vector<std::uint64_t> block(2 * static_cast<std::size_t>(particles_->rows()));
  file.read("/bond_words", particles_->first(), 2, std::span<std::uint64_t>(block));
  for (std::size_t p = 0; p < d_.bonds->parts().size(); ++p) {
    std::vector<PetscInt> wanted;
    for (const Index site : d_.bonds->parts()[p]->word_sites())
      wanted.push_back(particle_number(static_cast<Index>(p), site));
    const io::NaturalOrder order(d_.system.rows.comm, first_.back() - first_[0], wanted);
    d_.bonds->set_words(p, order.from_table(block, 2));
  }
  if (!d_.carried) return;
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(file.shape("/broken_carried_bonds")[0]));
  file.read("/broken_carried_bonds", 0, 1, std::span<std::uint64_t>(keys));
  d_.carried->set_broken(keys);
}

void SceneState::read(const io::Hdf5Reader& file, const solve::TimeDriver::Clock& clock,
                      solve::TimeDriver& driver) const
{
  if (d_.breaker) read_bonds(file);
  const std::vector<double> u = read_rows(file, "/displacement"), v = read_rows(file, "/velocity"),
                            a = read_rows(file, "/acceleration"), force = read_rows(file, "/held_force");
  std::vector<double> held;
  for (const Index c : d_.system.prescribed.components) held.push_back(force[static_cast<std::size_t>(c)]);
  driver.resume(clock, {u, v, a, held});
}

void SceneState::write_cracks(io::Hdf5File& file, const CrackNotes& notes) const
{
  const post::CrackTracker::State& tracker = notes.tracker;
  int rank = 0;
  MPI_Comm_rank(d_.system.rows.comm, &rank);
  std::vector<double> table;
  auto arrival = tracker.arrivals.begin();
  for (std::size_t look = 0; look < tracker.per_look.size() && rank == 0; ++look)
    for (int k = 0; k < tracker.per_look[look]; ++k, ++arrival)
      for (const double entry : {static_cast<double>(arrival->patch), static_cast<double>(arrival->site), arrival->time,
                                 static_cast<double>(look)})
        table.push_back(entry);
  file.dataset(kArrivals, std::span<const double>(table), 4);
  file.attribute(kArrivals, "time", tracker.time);
  file.attribute(kArrivals, "largest_speed", tracker.largest_speed);
  file.attribute(kArrivals, "bonds_broken", static_cast<double>(notes.bonds_broken));
  const std::vector<double> block = particles_->to_table(tracker.damage, 1);
  file.dataset("/crack_damage", std::span<const double>(block), 1);
}

std::optional<CrackNotes> SceneState::read_cracks(const io::Hdf5Reader& file) const
{
  if (!file.has(kArrivals)) return std::nullopt;
  CrackNotes notes{std::llround(file.real(kArrivals, "bonds_broken")), {}};
  notes.tracker.time = file.real(kArrivals, "time");
  notes.tracker.largest_speed = file.real(kArrivals, "largest_speed");
  std::vector<double> table(4 * static_cast<std::size_t>(file.shape(kArrivals)[0]));
  file.read(kArrivals, 0, 4, std::span<double>(table));
  for (std::size_t k = 0; k < table.size(); k += 4) {
    notes.tracker.arrivals.push_back({static_cast<Index>(table[k]), static_cast<Index>(table[k + 1]), table[k + 2]});
    notes.tracker.per_look.resize(static_cast<std::size_t>(table[k + 3]) + 1);
    ++notes.tracker.per_look.back();
  }
  std::vector<double> block(static_cast<std::size_t>(particles_->rows()));
  file.read("/crack_damage", particles_->first(), 1, std::span<double>(block));
  notes.tracker.damage = particles_->from_table(block, 1);
  return notes;
}
} // namespace pdx::app
