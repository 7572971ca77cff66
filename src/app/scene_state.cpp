#include "pdx/app/scene_state.hpp"

#include "pdx/app/cloud_body.hpp"
#include "pdx/app/scene_signature.hpp"
#include "pdx/app/solid.hpp"
#include "pdx/base/fingerprint.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::app {
namespace {
constexpr const char* kArrivals = "/crack_arrivals";      // patch, site, time [s], look
constexpr const char* kCracks = "/crack_numbers";         // time [s], largest speed [m/s], bonds broken
constexpr const char* kCarried = "/broken_carried_bonds"; // their keys, ascending

/// An enriched set by what does not depend on the number of ranks: vertex, crack.
using SetName = std::array<Index, 2>;

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

/// A patch in the plane, or a solid.
template <int Dim> std::string line_of(const geom::Lattice<Dim>& lattice, std::size_t bonds)
{
  return fmt::format("{} particles {} m apart from ({}), {} bonds\n", fmt::join(lattice.count, " x "), lattice.dx,
                     fmt::join(lattice.origin.data(), lattice.origin.data() + Dim, ", "), bonds);
}

std::string lines_of(const SceneOptions& options, const Standing& scene)
{
  const law::Elastic& m = options.elastic;
  std::string text =
      fmt::format("material = E {} nu {} rho {} thickness {} {}\nkinematics = {}\nscheme = {}\n", m.young, m.poisson,
                  m.density, m.thickness, m.plane == law::Plane::stress ? "plane stress" : "plane strain",
                  static_cast<int>(options.kinematics), static_cast<int>(options.scheme));
  if (scene.solid) {
    const pd::LatticePart<3>& part = *scene.solid->bonds->parts()[0];
    text += "solid = " + line_of<3>(part.lattice(), part.stencil().half.size());
  }
  if (scene.cloud) text += fmt::format("cloud = {}\n", scene.cloud->description);
  for (std::size_t p = 0; scene.plan && p < scene.plan->shapes.size(); ++p) {
    const couple::PatchShape& shape = scene.plan->shapes[p];
    text += fmt::format("patch {} = ", p + 1) + line_of<2>(shape.lattice, scene.plan->stencils[p].half.size());
    for (const geom::Box<2>& box : shape.boxes)
      if (!shape.active.is_box())
        text += fmt::format("box of patch {} = {} {} {} {}\n", p + 1, box.lower[0], box.lower[1], box.upper[0],
                            box.upper[1]);
  }
  text += fmt::format("bonds = micromodulus {}, calibration {}, surface correction {}\n",
                      static_cast<int>(options.pd.micromodulus), static_cast<int>(options.pd.calibration),
                      static_cast<int>(options.pd.surface_correction));
  text += fmt::format("corner of the body = {}\n", fmt::join(options.frame.origin(), ", "));
  for (const geom::Box<2>& box : options.fracture.no_fail)
    text += fmt::format("no-fail zone = {} {} {} {}\n", box.lower[0], box.lower[1], box.upper[0], box.upper[1]);
  for (std::size_t c = 0; c < options.cracks.lines.size(); ++c) {
    text += fmt::format("crack {} =", c + 1);
    for (const Vector<2>& x : options.cracks.lines[c]) text += fmt::format(" ({}, {})", x[0], x[1]);
    text += "\n";
  }
  return text;
}
} // namespace

SceneState::SceneState(const Standing& scene, const SceneOptions& options) : scene_(scene), model_(*scene.model)
{
  number_rows();
  describe(options);
}

template <class Visit> void SceneState::with_bonds(Visit&& visit) const
{
  if (scene_.solid)
    visit(*scene_.solid->bonds);
  else if (scene_.d && scene_.d->bonds)
    visit(*scene_.d->bonds);
}

void SceneState::number_rows()
{
  const mesh::Mesh& mesh = *scene_.mesh;
  const MPI_Comm comm = model_.system.rows.comm;
  const std::vector<SetName> mine = scene_.d ? names_of_sets(mesh, *scene_.d) : std::vector<SetName>();
  std::vector<SetName> all = gather_all(comm, mine);
  std::ranges::sort(all);
  sets_ = static_cast<PetscInt>(all.size());
  first_.assign(1, scene_.mesh->global_vertices() + sets_);
  with_bonds([&](const auto& bonds) {
    for (const auto& part : bonds.parts())
      first_.push_back(first_.back() + static_cast<PetscInt>(part->active().size()));
  });
  if (scene_.cloud) first_.push_back(first_.back() + model_.system.rows.total);

  std::vector<PetscInt> held, particles;
  if (scene_.d)
    for (const Index v : scene_.d->nodes) held.push_back(mesh.natural_vertex(v));
  for (const SetName& name : mine)
    held.push_back(scene_.mesh->global_vertices() +
                   static_cast<PetscInt>(std::ranges::lower_bound(all, name) - all.begin()));
  for (const pd::Particle& p : model_.particles) {
    held.push_back(first_[0] + particle_number(p.patch, p.site));
    particles.push_back(particle_number(p.patch, p.site));
  }
  note_supports(held);
  rows_ = std::make_unique<io::NaturalOrder>(comm, first_.back(), held);
  particles_ = std::make_unique<io::NaturalOrder>(comm, first_.back() - first_[0], particles);
}

/// A sum over the held components that tells where they are, on any number of ranks.
void SceneState::note_supports(std::span<const PetscInt> numbers)
{
  const Index dim = model_.system.rows.dim;
  std::uint64_t sums[2] = {model_.system.prescribed.components.size(), 0};
  for (const Index component : model_.system.prescribed.components) {
    const Index place[2] = {numbers[static_cast<std::size_t>(component / dim)], component % dim};
    sums[1] += Fingerprint().add(std::span<const Index>(place)).value();
  }
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_UINT64_T, MPI_SUM, model_.system.rows.comm);
  supports_ = fmt::format("{} held components, {:016x}", sums[0], sums[1]);
}

PetscInt SceneState::particle_number(Index patch, Index site) const
{
  return first_[static_cast<std::size_t>(patch)] - first_[0] + site;
}

void SceneState::describe(const SceneOptions& options)
{
  std::int64_t counts[2] = {model_.system.rows.nodes, model_.system.rows.particles};
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, model_.system.rows.comm);
  text_ = fmt::format("vertices = {}\nnodes = {}\nenriched sets = {}\nparticles = {}\n", scene_.mesh->global_vertices(),
                      counts[0], sets_, counts[1]);
  text_ += fmt::format("supports = {}\n", supports_);
  text_ += lines_of(options, scene_);
  text_ += fmt::format("critical stretch = {}\n", fmt::join(model_.critical_stretch, ", "));
  text_ += scene_signature(model_.system.rows.comm);
}

void SceneState::write(io::Hdf5File& file, const solve::TimeDriver& driver) const
{
  const solve::TimeDriver::State state = driver.state();
  const int dim = model_.system.rows.dim;
  std::vector<double> held(state.u.size(), 0.0);
  for (std::size_t k = 0; k < state.held.size(); ++k)
    held[static_cast<std::size_t>(model_.system.prescribed.components[k])] = state.held[k];
  const auto table = [&](const std::string& name, std::span<const double> values) {
    const std::vector<double> block = rows_->to_table(values, dim);
    file.dataset(name, std::span<const double>(block), dim);
  };
  table("/displacement", state.u);
  table("/velocity", state.v);
  table("/acceleration", state.a);
  table("/held_force", held);
  if (!model_.breaker) return;

  std::vector<std::uint64_t> words;
  if (scene_.cloud) words = scene_.cloud->words();
  with_bonds([&](const auto& bonds) {
    for (const auto& part : bonds.parts())
      for (Index k = 0; k < static_cast<Index>(part->sites().size()); ++k)
        for (const std::uint64_t word : part->words_of(k)) words.push_back(word);
  });
  const std::vector<std::uint64_t> block = particles_->to_table(words, words_per_particle());
  file.dataset("/bond_words", std::span<const std::uint64_t>(block), words_per_particle());
  if (!scene_.d || !scene_.d->carried) return;
  std::vector<std::uint64_t> keys = gather_all(model_.system.rows.comm, scene_.d->carried->broken());
  std::ranges::sort(keys);
  int rank = 0;
  MPI_Comm_rank(model_.system.rows.comm, &rank);
  if (rank) keys.clear();
  file.dataset(kCarried, std::span<const std::uint64_t>(keys), 1);
}

int SceneState::words_per_particle() const { return scene_.cloud ? scene_.cloud->words_per_particle() : 2; }

std::vector<double> SceneState::read_rows(const io::SealedReader& file, const std::string& name) const
{
  const int dim = model_.system.rows.dim;
  std::vector<double> block(static_cast<std::size_t>(dim) * static_cast<std::size_t>(rows_->rows()));
  file.read(name, rows_->first(), dim, std::span<double>(block));
  return rows_->from_table(block, dim);
}

void SceneState::read_bonds(const io::SealedReader& file) const
{
  const int width = words_per_particle();
  std::vector<std::uint64_t> block(static_cast<std::size_t>(width) * static_cast<std::size_t>(particles_->rows()));
  file.read("/bond_words", particles_->first(), width, std::span<std::uint64_t>(block));
  if (scene_.cloud) return scene_.cloud->set_words(particles_->from_table(block, width));
  with_bonds([&](auto& bonds) {
    for (std::size_t p = 0; p < bonds.parts().size(); ++p) {
      std::vector<PetscInt> wanted;
      for (const Index site : bonds.parts()[p]->word_sites())
        wanted.push_back(particle_number(static_cast<Index>(p), site));
      const io::NaturalOrder order(model_.system.rows.comm, first_.back() - first_[0], wanted);
      bonds.set_words(p, order.from_table(block, 2));
    }
  });
  if (!scene_.d || !scene_.d->carried) return;
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(file.shape(kCarried)[0]));
  file.read(kCarried, 0, 1, std::span<std::uint64_t>(keys));
  file.require(kCarried, std::ranges::is_sorted(keys) ? "" : "is not in order");
  scene_.d->carried->set_broken(keys);
}

void SceneState::read(const io::SealedReader& file, const solve::TimeDriver::Clock& clock,
                      solve::TimeDriver& driver) const
{
  if (model_.breaker) read_bonds(file);
  const std::vector<double> u = read_rows(file, "/displacement"), v = read_rows(file, "/velocity"),
                            a = read_rows(file, "/acceleration"), force = read_rows(file, "/held_force");
  std::vector<double> held;
  for (const Index c : model_.system.prescribed.components) held.push_back(force[static_cast<std::size_t>(c)]);
  driver.resume(clock, {u, v, a, held});
}

/// Whether a CrackWatch looks at owned particle k: in a solid only at those of the middle layer.
bool SceneState::is_watched(std::size_t k) const
{
  if (!scene_.solid) return true;
  const geom::Lattice<3>& lattice = scene_.solid->bonds->parts()[0]->lattice();
  return lattice.site(scene_.solid->particles[k].site)[2] == lattice.count[2] / 2;
}

void SceneState::write_cracks(io::Hdf5File& file, const CrackNotes& notes) const
{
  const post::CrackTracker::State& tracker = notes.tracker;
  int rank = 0;
  MPI_Comm_rank(model_.system.rows.comm, &rank);
  std::vector<double> table;
  auto arrival = tracker.arrivals.begin();
  for (std::size_t look = 0; look < tracker.per_look.size() && rank == 0; ++look)
    for (int k = 0; k < tracker.per_look[look]; ++k, ++arrival)
      for (const double entry : {static_cast<double>(arrival->patch), static_cast<double>(arrival->site), arrival->time,
                                 static_cast<double>(look)})
        table.push_back(entry);
  file.dataset(kArrivals, std::span<const double>(table), 4);
  std::vector<double> numbers{tracker.time, tracker.largest_speed, static_cast<double>(notes.bonds_broken)};
  if (rank) numbers.clear();
  file.dataset(kCracks, std::span<const double>(numbers), 1);
  std::vector<double> damage(model_.particles.size(), 0.0);
  auto watched = tracker.damage.begin();
  for (std::size_t k = 0; k < damage.size(); ++k)
    if (is_watched(k)) damage[k] = *watched++;
  const std::vector<double> block = particles_->to_table(damage, 1);
  file.dataset("/crack_damage", std::span<const double>(block), 1);
}

/// Why a row of the table of arrivals cannot follow those before it, "" if it can.
std::string SceneState::fault_of_arrival(std::span<const double> row, const post::CrackTracker::State& before) const
{
  const double patches = static_cast<double>(first_.size()) - 1.0;
  const auto is_number = [](double value, double end) {
    return value >= 0.0 && value < end && value == std::floor(value);
  };
  if (!is_number(row[0], patches)) return fmt::format("has patch {}, of {}", row[0], patches);
  const auto patch = static_cast<std::size_t>(row[0]);
  const double sites = first_[patch + 1] - first_[patch];
  if (!is_number(row[1], sites)) return fmt::format("has site {}, of {}", row[1], sites);
  const auto looks = static_cast<double>(before.per_look.size());
  if (row[3] != looks && (looks == 0.0 || row[3] != looks - 1.0))
    return fmt::format("has look {} behind {}", row[3], looks);
  return row[2] >= 0.0 ? "" : fmt::format("has time {} s", row[2]);
}

std::optional<CrackNotes> SceneState::read_cracks(const io::SealedReader& file) const
{
  if (!file.has(kArrivals)) return std::nullopt;
  const std::vector<double> numbers = file.column(kCracks);
  const bool good = numbers.size() == 3 && std::ranges::all_of(numbers, [](double n) { return n >= 0.0 && n < 1e15; });
  file.require(kCracks, good ? "" : "must hold three numbers, none below 0");
  CrackNotes notes{std::llround(numbers[2]), {}};
  notes.tracker.time = numbers[0];
  notes.tracker.largest_speed = numbers[1];
  std::vector<double> table(4 * static_cast<std::size_t>(file.shape(kArrivals)[0]));
  file.read(kArrivals, 0, 4, std::span<double>(table));
  for (std::size_t k = 0; k < table.size(); k += 4) {
    file.require(kArrivals, fault_of_arrival({table.data() + k, 4}, notes.tracker));
    notes.tracker.arrivals.push_back({static_cast<Index>(table[k]), static_cast<Index>(table[k + 1]), table[k + 2]});
    notes.tracker.per_look.resize(static_cast<std::size_t>(table[k + 3]) + 1);
    ++notes.tracker.per_look.back();
  }
  std::vector<double> block(static_cast<std::size_t>(particles_->rows()));
  file.read("/crack_damage", particles_->first(), 1, std::span<double>(block));
  const std::vector<double> damage = particles_->from_table(block, 1);
  for (std::size_t k = 0; k < damage.size(); ++k)
    if (is_watched(k)) notes.tracker.damage.push_back(damage[k]);
  return notes;
}
} // namespace pdx::app
