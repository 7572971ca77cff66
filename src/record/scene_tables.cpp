#include "pdx/record/scene_tables.hpp"

#include "pdx/base/fingerprint.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pdx::record {
namespace {
constexpr const char* kVelocity = "/velocity"; // in time only
constexpr const char* kInner = "/inner";
constexpr const char* kGripNames = "/grip_names";
constexpr const char* kGrips = "/grips";
constexpr const char* kRows = "/row_names";
constexpr const char* kWords = "/gone_bonds";                 // of each particle, a bit for each bond it had
constexpr const char* kArrivals = "/crack_arrivals";          // name, look
constexpr const char* kArrivalTimes = "/crack_arrival_times"; // [s]
constexpr const char* kCracks = "/crack_numbers";             // time [s], largest speed [m/s], bonds broken
constexpr const char* kDamage = "/crack_damage";
constexpr const char* kCarried = "/broken_carried_bonds"; // their names, ascending

bool is_first(MPI_Comm comm)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank == 0;
}

std::vector<std::uint64_t> values_of(std::span<const field::RowName> names)
{
  std::vector<std::uint64_t> values(names.size());
  std::ranges::transform(names, values.begin(), &field::RowName::value);
  return values;
}
} // namespace

SceneTables::SceneTables(const scene::Standing& scene) : scene_(scene), model_(*scene.model)
{
  number_rows();
  describe();
}

void SceneTables::number_rows()
{
  const MPI_Comm comm = model_.system.rows.comm;
  const scene::SceneNames names(scene_);
  std::vector<std::uint64_t> sets;
  for (const field::RowName name : names.rows())
    if (name.kind() == field::RowName::Kind::set) sets.push_back(name.value());
  sets = gather_all(comm, sets);
  std::ranges::sort(sets);
  sets_ = static_cast<PetscInt>(sets.size());
  std::vector<PetscInt> first{0}; // of each patch, and behind the last
  for (const auto& part : model_.parts) part->add_numbers(first);
  particles_ = first.back();

  PetscInt vertices = scene_.mesh->global_vertices(); // or nodes, of which columns over a vertex have more
  for (const field::RowName name : names.rows())
    if (name.kind() == field::RowName::Kind::node) vertices = std::max(vertices, static_cast<PetscInt>(name.key()) + 1);
  MPI_Allreduce(MPI_IN_PLACE, &vertices, 1, MPIU_INT, MPI_MAX, comm);
  std::vector<PetscInt> rows, particles;
  for (const field::RowName name : names.rows())
    if (name.kind() == field::RowName::Kind::node)
      rows.push_back(static_cast<PetscInt>(name.key()));
    else if (name.kind() == field::RowName::Kind::set)
      rows.push_back(vertices + static_cast<PetscInt>(std::ranges::lower_bound(sets, name.value()) - sets.begin()));
  for (const pd::Particle& p : model_.particles) particles.push_back(first[static_cast<std::size_t>(p.patch)] + p.site);
  for (const PetscInt number : particles) rows.push_back(vertices + sets_ + number);
  note_supports(rows);
  row_order_ = std::make_unique<io::NaturalOrder>(comm, vertices + sets_ + particles_, rows);
  particle_order_ = std::make_unique<io::NaturalOrder>(comm, particles_, particles);
}

/// A sum over the held components that tells where they are, on any number of ranks.
void SceneTables::note_supports(std::span<const PetscInt> numbers)
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

void SceneTables::describe()
{
  std::int64_t counts[2] = {model_.system.rows.nodes, model_.system.rows.particles};
  MPI_Allreduce(MPI_IN_PLACE, counts, 2, MPI_INT64_T, MPI_SUM, model_.system.rows.comm);
  text_ = fmt::format("vertices = {}\nnodes = {}\nenriched sets = {}\nparticles = {}\n", scene_.mesh->global_vertices(),
                      counts[0], sets_, counts[1]);
  text_ += fmt::format("supports = {}\n", supports_);
  text_ += model_.described();
  text_ += fmt::format("critical stretch = {}\n", fmt::join(model_.critical_stretch, ", "));
}

namespace {
void write_cracks(io::Hdf5File& file, const scene::NamedCracks& cracks, const io::NaturalOrder& particles, bool first)
{
  std::vector<std::uint64_t> names;
  std::vector<double> times = cracks.arrival_times,
                      numbers{cracks.time, cracks.largest_speed, static_cast<double>(cracks.bonds_broken)};
  auto arrival = cracks.arrivals.begin();
  for (std::size_t look = 0; look < cracks.per_look.size() && first; ++look)
    for (int k = 0; k < cracks.per_look[look]; ++k, ++arrival)
      names.insert(names.end(), {arrival->value(), static_cast<std::uint64_t>(look)});
  if (!first) {
    times.clear();
    numbers.clear();
  }
  file.dataset(kArrivals, std::span<const std::uint64_t>(names), 2);
  file.dataset(kArrivalTimes, std::span<const double>(times), 1);
  file.dataset(kCracks, std::span<const double>(numbers), 1);
  const std::vector<double> block = particles.to_table(cracks.damage, 1);
  file.dataset(kDamage, std::span<const double>(block), 1);
}
} // namespace

void SceneTables::write(io::Hdf5File& file, const scene::NamedState& state) const
{
  const std::vector<std::uint64_t> names = row_order_->to_table(values_of(state.rows), 1);
  file.dataset(kRows, std::span<const std::uint64_t>(names), 1);
  const auto table = [&](const char* name, std::span<const double> values) {
    const std::vector<double> block = row_order_->to_table(values, state.dim);
    file.dataset(name, std::span<const double>(block), state.dim);
  };
  table("/displacement", state.moving.u);
  if (state.in_time) {
    table(kVelocity, state.moving.v);
    table("/acceleration", state.moving.a);
    table("/held_force", state.moving.held);
  }
  if (const auto& steps = model_.system.steps) {
    const std::vector<double> block = row_order_->to_table(state.moving.inner, steps->width());
    file.dataset(kInner, std::span<const double>(block), steps->width());
  }
  const bool first = is_first(model_.system.rows.comm);
  if (state.words_per_particle > 0) {
    const std::vector<std::uint64_t> block = particle_order_->to_table(state.gone, state.words_per_particle);
    file.dataset(kWords, std::span<const std::uint64_t>(block), state.words_per_particle);
  }
  if (state.carried) {
    const std::span<const std::uint64_t> all(*state.carried);
    file.dataset(kCarried, all.first(first ? all.size() : 0), 1);
  }
  if (state.grips) {
    const std::span<const std::uint64_t> grip_names(state.grips->names);
    const std::span<const double> numbers(state.grips->numbers);
    file.dataset(kGripNames, grip_names.first(first ? grip_names.size() : 0), state.dim + 2);
    file.dataset(kGrips, numbers.first(first ? numbers.size() : 0), state.dim + 1);
  }
  if (state.cracks) write_cracks(file, *state.cracks, *particle_order_, first);
}

namespace {
/// This rank's share of a table.
template <class T> class Share {
public:
  Share(MPI_Comm comm, const io::SealedReader& file, std::int64_t total)
      : file_(file), block_(io::block_of(comm, static_cast<PetscInt>(total)))
  {}
  std::vector<T> read(const std::string& name, std::int64_t offset, int components) const
  {
    std::vector<T> values(static_cast<std::size_t>(block_.rows) * static_cast<std::size_t>(components));
    file_.read(name, offset + block_.first, components, std::span<T>(values));
    return values;
  }

private:
  const io::SealedReader& file_;
  io::Block block_;
};

std::vector<field::RowName> names_of(const std::vector<std::uint64_t>& values)
{
  std::vector<field::RowName> names(values.size());
  std::ranges::transform(values, names.begin(), &field::RowName::from);
  return names;
}

scene::NamedCracks read_cracks(MPI_Comm comm, const io::SealedReader& file, std::int64_t particles)
{
  scene::NamedCracks cracks;
  const std::vector<double> numbers = file.column(kCracks);
  const bool good = numbers.size() == 3 && std::ranges::all_of(numbers, [](double n) { return n >= 0.0 && n < 1e15; });
  file.require(kCracks, good ? "" : "must hold three numbers, none below 0");
  cracks.time = numbers[0];
  cracks.largest_speed = numbers[1];
  cracks.bonds_broken = std::llround(numbers[2]);
  cracks.arrival_times = file.column(kArrivalTimes);
  std::vector<std::uint64_t> table(2 * static_cast<std::size_t>(file.shape(kArrivals)[0]));
  file.read(kArrivals, 0, 2, std::span<std::uint64_t>(table));
  file.require(kArrivalTimes, 2 * cracks.arrival_times.size() == table.size() ? "" : "has other rows than the names");
  for (std::size_t k = 0; k < table.size(); k += 2) {
    const std::uint64_t looks = cracks.per_look.size(), look = table[k + 1];
    const bool follows = look == looks || (looks > 0 && look == looks - 1);
    file.require(kArrivals, follows ? "" : fmt::format("has look {} behind {}", look, looks));
    cracks.arrivals.push_back(field::RowName::from(table[k]));
    cracks.per_look.resize(look + 1);
    ++cracks.per_look.back();
  }
  cracks.damage = Share<double>(comm, file, particles).read(kDamage, 0, 1);
  return cracks;
}
} // namespace

scene::NamedState read_tables(MPI_Comm comm, const io::SealedReader& file, int dim)
{
  const std::int64_t rows = file.shape(kRows)[0];
  file.require(kRows, rows < std::numeric_limits<PetscInt>::max() ? "" : "has too many rows");
  const Share<double> values(comm, file, rows);
  scene::NamedState state;
  state.dim = dim;
  state.rows = names_of(Share<std::uint64_t>(comm, file, rows).read(kRows, 0, 1));
  state.moving.u = values.read("/displacement", 0, dim);
  state.in_time = file.has(kVelocity);
  if (state.in_time) {
    state.moving.v = values.read(kVelocity, 0, dim);
    state.moving.a = values.read("/acceleration", 0, dim);
    state.moving.held = values.read("/held_force", 0, dim);
  }
  if (file.has(kInner)) state.moving.inner = values.read(kInner, 0, static_cast<int>(file.shape(kInner)[1]));
  const bool breaks = file.has(kWords);
  const std::int64_t particles = breaks ? file.shape(kWords)[0] : 0;
  file.require(kWords, particles <= rows ? "" : "has more rows than there are names");
  const Share<std::uint64_t> words(comm, file, particles);
  state.particles = names_of(words.read(kRows, rows - particles, 1)); // particles come last
  if (breaks) {
    state.words_per_particle = static_cast<int>(file.shape(kWords)[1]);
    state.gone = words.read(kWords, 0, state.words_per_particle);
  }
  if (file.has(kCarried)) {
    std::vector<std::uint64_t> names(static_cast<std::size_t>(file.shape(kCarried)[0]));
    file.read(kCarried, 0, 1, std::span<std::uint64_t>(names));
    file.require(kCarried, std::ranges::is_sorted(names) ? "" : "is not in order");
    state.carried = std::move(names);
  }
  if (file.has(kGrips)) {
    scene::NamedGrips grips;
    grips.names.resize(static_cast<std::size_t>(file.shape(kGripNames)[0]) * static_cast<std::size_t>(dim + 2));
    grips.numbers.resize(static_cast<std::size_t>(file.shape(kGrips)[0]) * static_cast<std::size_t>(dim + 1));
    file.read(kGripNames, 0, dim + 2, std::span<std::uint64_t>(grips.names));
    file.read(kGrips, 0, dim + 1, std::span<double>(grips.numbers));
    state.grips = std::move(grips);
  }
  if (file.has(kArrivals)) state.cracks = read_cracks(comm, file, particles);
  return state;
}
} // namespace pdx::record
