#include "pdx/scene/named_state.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <stdexcept>

namespace pdx::scene {
namespace {
constexpr std::size_t kRoom = 4096; // components

int words_per_particle(const Model& model)
{
  int width = 0;
  for (const auto& part : model.parts) width += part->words_per_particle();
  return width;
}

std::vector<std::uint64_t> gone_in(const Model& model)
{
  std::vector<std::uint64_t> words;
  for (const auto& part : model.parts) {
    std::vector<std::uint64_t> more = part->gone();
    if (words.empty())
      words = std::move(more);
    else
      words.insert(words.end(), more.begin(), more.end());
  }
  return words;
}

bool carries_bonds(const Model& model)
{
  return std::ranges::any_of(model.parts, [](const auto& part) { return part->carries_bonds(); });
}

NamedCracks named(const CrackNotes& notes, const SceneNames& names)
{
  const track::CrackTracker::State& tracker = notes.tracker;
  NamedCracks cracks{notes.bonds_broken, tracker.time, tracker.largest_speed, {}, {}, tracker.per_look, {}};
  for (const track::Arrival& arrival : tracker.arrivals) {
    cracks.arrivals.push_back(field::RowName::particle(arrival.site));
    cracks.arrival_times.push_back(arrival.time);
  }
  cracks.damage.assign(names.particles().size(), 0.0);
  std::size_t watched = 0;
  for (std::size_t k = 0; k < cracks.damage.size() && !tracker.damage.empty(); ++k)
    if (names.is_watched(k)) cracks.damage[k] = tracker.damage.at(watched++);
  if (watched != tracker.damage.size()) throw std::logic_error("damage was noted of particles that are not here");
  return cracks;
}

/// @param damage of the scene's own particles
CrackNotes placed(const NamedCracks& cracks, std::span<const double> damage, const SceneNames& names)
{
  CrackNotes notes{cracks.bonds_broken, {cracks.time, cracks.largest_speed, {}, cracks.per_look, {}}};
  for (std::size_t k = 0; k < cracks.arrivals.size(); ++k)
    notes.tracker.arrivals.push_back({cracks.arrivals[k].key(), cracks.arrival_times[k]});
  for (std::size_t k = 0; k < damage.size(); ++k)
    if (names.is_watched(k)) notes.tracker.damage.push_back(damage[k]);
  return notes;
}

std::span<const field::RowName> names_with_words(const Standing& scene, const SceneNames& names)
{
  return names.particles().first(scene.model->breaks() ? names.particles().size() : 0);
}

void add_carried(const Standing& scene, NamedState& state)
{
  if (!carries_bonds(*scene.model)) return;
  std::vector<std::uint64_t> mine;
  for (const auto& part : scene.model->parts) {
    const std::vector<std::uint64_t> more = part->broken_carried();
    mine.insert(mine.end(), more.begin(), more.end());
  }
  state.carried = gather_all(scene.model->system.rows.comm, mine);
  std::ranges::sort(*state.carried);
}

NamedState what_is_owned(const Standing& scene, const SceneNames& names)
{
  const field::System& system = scene.model->system;
  NamedState state;
  state.dim = system.rows.dim;
  state.rows.assign(names.rows().begin(), names.rows().end());
  state.particles.assign(names.particles().begin(), names.particles().end());
  if (!scene.model->breaks()) return state;
  state.words_per_particle = words_per_particle(*scene.model);
  state.gone = gone_in(*scene.model);
  add_carried(scene, state);
  return state;
}
} // namespace

NamedState capture(const Standing& scene) { return what_is_owned(scene, SceneNames(scene)); }

NamedState capture(const Standing& scene, const solve::TimeDriver& driver, const std::optional<CrackNotes>& cracks,
                   Moves moves)
{
  const SceneNames names(scene);
  NamedState state = what_is_owned(scene, names);
  state.in_time = true;
  if (moves == Moves::all)
    state.moving = driver.state();
  else
    for (const auto& [from, to] : {std::pair{driver.u(), &state.moving.u}, std::pair{driver.v(), &state.moving.v}}) {
      to->reserve(from.size() + kRoom); // for rows to come
      to->assign(from.begin(), from.end());
    }
  if (scene.model->touching) state.grips = scene.model->touching->grips();
  if (cracks) state.cracks = named(*cracks, names);
  return state;
}

NamedState capture_around(const Standing& scene)
{
  NamedState state;
  state.dim = scene.model->system.rows.dim;
  state.in_time = true;
  if (scene.model->breaks()) {
    state.words_per_particle = words_per_particle(*scene.model);
    add_carried(scene, state);
  }
  if (scene.model->touching) state.grips = scene.model->touching->grips();
  return state;
}

void add_leaving(NamedState& state, const Standing& now, const Handed& handed, Passing& before)
{
  const field::StayingRows& stay = handed.rows;
  const std::vector<Index> leaving = stay.leaving();
  state.rows = stay.names;
  state.moving.u = field::values_of(leaving, before.values.u, state.dim);
  state.moving.v = field::values_of(leaving, before.values.v, state.dim);
  for (const field::RowName name : stay.names)
    if (name.kind() == field::RowName::Kind::particle) state.particles.push_back(name);
  if (state.words_per_particle > 0) state.gone = handed.gone;
  stay.carry(before.values.u, state.dim);
  stay.carry(before.values.v, state.dim);
  if (!before.cracks) return;
  NamedCracks& cracks = state.cracks.emplace();
  std::vector<double>& damage = before.cracks->tracker.damage;
  cracks.damage.assign(state.particles.size(), -1.0);
  if (damage.empty()) return;
  const field::Rows& rows = now.model->system.rows;
  const field::StayingRows particles = stay.behind(before.first_particle, rows.first_particle());
  cracks.damage = field::values_of(particles.leaving(), damage, 1);
  particles.carry(damage, 1);
}

void add_rows(NamedState& state, const adapt::FreshRows& fresh)
{
  state.rows.insert(state.rows.end(), fresh.names.begin(), fresh.names.end());
  for (const field::RowName name : fresh.names)
    if (name.kind() == field::RowName::Kind::particle) state.particles.push_back(name);
  state.gone.resize(state.particles.size() * static_cast<std::size_t>(state.words_per_particle), 0);
  if (state.cracks) state.cracks->damage.resize(state.particles.size(), -1.0);
  const auto append = [&fresh](std::vector<double>& to, std::size_t field) {
    if (field < fresh.fields.size()) to.insert(to.end(), fresh.fields[field].begin(), fresh.fields[field].end());
  };
  append(state.moving.u, 0);
  append(state.moving.v, 1);
  for (std::vector<double>* later : {&state.moving.a, &state.moving.held})
    if (!later->empty()) later->resize(state.moving.u.size(), 0.0);
}

namespace {
/// Those that the state is about.
std::vector<Index> rows_of(const Standing& scene, const field::StayingRows* stay)
{
  if (stay) return stay->coming();
  std::vector<Index> all(static_cast<std::size_t>(scene.model->system.rows.owned()));
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

/// What a run has named itself has no name twice.
field::RowMove::Wanted wanted_of(StateMove::From from)
{
  return from == StateMove::From::file ? field::RowMove::Wanted::often : field::RowMove::Wanted::once;
}
} // namespace

StateMove::StateMove(const NamedState& state, const Standing& scene, From from, const field::StayingRows* stay)
    : state_(state), scene_(scene), changed_(from == From::changed), coming_(rows_of(scene, stay)),
      names_(stay ? SceneNames(scene, coming_) : SceneNames(scene)),
      rows_(scene.model->system.rows.comm, state.rows, names_.rows(), wanted_of(from)),
      particles_(scene.model->system.rows.comm, state.particles, names_with_words(scene, names_), wanted_of(from)),
      misfit_(misfit_of())
{}

Misfit StateMove::misfit_of() const
{
  if (!rows_.unique() || !particles_.unique()) return {"/row_names", "has a name twice"};
  if (any_rank(scene_.model->system.rows.comm, !rows_.fresh().empty() || !particles_.fresh().empty()))
    return {"/row_names", "has not every row of the scene"};
  if (const auto& steps = scene_.model->system.steps)
    if (state_.moving.inner.size() != state_.rows.size() * static_cast<std::size_t>(steps->width()))
      return {"/inner", "is missing or has other columns"};
  const bool breaks = scene_.model->breaks();
  if (const int width = breaks ? words_per_particle(*scene_.model) : 0; state_.words_per_particle != width)
    return {"/gone_bonds", fmt::format("has {} words a particle: must be {}", state_.words_per_particle, width)};
  if (!changed_ && breaks && carries_bonds(*scene_.model) && !state_.carried) // else all were particles
    return {"/broken_carried_bonds", "is missing"};
  if (state_.grips && state_.grips->names.size() * static_cast<std::size_t>(state_.dim + 1) !=
                          state_.grips->numbers.size() * static_cast<std::size_t>(state_.dim + 2))
    return {"/grips", "has other rows than the names"};
  if (!state_.cracks) return {};
  const auto particle = [](field::RowName name) { return name.kind() == field::RowName::Kind::particle; };
  if (!std::ranges::all_of(state_.cracks->arrivals, particle)) return {"/crack_arrivals", "names what is no particle"};
  const bool early = std::ranges::any_of(state_.cracks->arrival_times, [](double time) { return time < 0.0; });
  return {"/crack_arrival_times", early ? "has a time before 0 s" : ""};
}

void StateMove::require_fit() const
{
  if (!misfit_.why.empty())
    throw std::logic_error(fmt::format("a change of layout lost state: {} {}", misfit_.table, misfit_.why));
}

std::vector<double> StateMove::rows(std::span<const double> values, int components) const
{
  return rows_.carry(values, components);
}

std::vector<Index> StateMove::came_after(std::size_t known) const
{
  std::vector<double> after(state_.rows.size(), 1.0);
  std::fill_n(after.begin(), known, 0.0);
  const std::vector<double> came = rows(after, 1);
  std::vector<Index> found;
  for (std::size_t k = 0; k < came.size(); ++k)
    if (came[k] > 0.0) found.push_back(coming_[k]);
  return found;
}

void StateMove::break_bonds() const
{
  const int width = state_.words_per_particle;
  if (width == 0) return;
  BrokenBonds broken{
      scene_.model->system.rows.comm, width, particles_.carry(state_.gone, width), {}, {}, nullptr, changed_};
  if (state_.carried) broken.carried = &*state_.carried;
  for (std::size_t k = 0; k < state_.particles.size(); ++k) {
    const auto words =
        std::span(state_.gone).subspan(k * static_cast<std::size_t>(width), static_cast<std::size_t>(width));
    if (std::ranges::all_of(words, [](std::uint64_t word) { return word == 0; })) continue;
    broken.torn.push_back(state_.particles[k]);
    broken.torn_words.insert(broken.torn_words.end(), words.begin(), words.end());
  }
  for (const auto& part : scene_.model->parts) part->add_torn(broken);
  for (const auto& part : scene_.model->parts)
    if (part->words_per_particle() > 0) part->break_bonds(broken);
}

std::vector<std::uint64_t> BrokenBonds::words_of(std::span<const field::RowName> wanted) const
{
  if (!any_rank(comm, !wanted.empty())) return {};
  return field::RowMove(comm, torn, wanted, field::RowMove::Wanted::known).carry(torn_words, width);
}

Dormant StateMove::dormant() const
{
  Dormant kept;
  if (state_.carried) kept.carried = *state_.carried;
  const auto width = static_cast<std::size_t>(state_.words_per_particle);
  if (width == 0) return kept;
  for (const Index k : particles_.left_behind()) {
    const auto words = std::span(state_.gone).subspan(static_cast<std::size_t>(k) * width, width);
    if (std::ranges::all_of(words, [](std::uint64_t word) { return word == 0; })) continue;
    kept.particles.push_back(state_.particles[static_cast<std::size_t>(k)]);
    kept.gone.insert(kept.gone.end(), words.begin(), words.end());
  }
  return kept;
}

void StateMove::hold_grips() const
{
  if (state_.grips && scene_.model->touching) scene_.model->touching->hold(*state_.grips);
}

field::State StateMove::moving() const
{
  const field::State& from = state_.moving;
  field::State to{rows(from.u, state_.dim), rows(from.v, state_.dim), {}, {}, {}};
  if (!changed_) {
    to.a = rows(from.a, state_.dim);
    to.held = rows(from.held, state_.dim);
  }
  if (const auto& steps = scene_.model->system.steps) to.inner = rows(from.inner, steps->width());
  return to;
}

void StateMove::place_damage(std::vector<double>& damage) const
{
  if (!state_.cracks || damage.empty()) return;
  const std::vector<double> of = particles_.carry(state_.cracks->damage, 1);
  const Index first = scene_.model->system.rows.first_particle();
  auto row = coming_.end() - static_cast<std::ptrdiff_t>(of.size());
  for (const double value : of) damage[static_cast<std::size_t>(*row++ - first)] = value;
}

std::optional<CrackNotes> StateMove::cracks() const
{
  if (!state_.cracks) return std::nullopt;
  return placed(*state_.cracks, particles_.carry(state_.cracks->damage, 1), names_);
}
} // namespace pdx::scene
