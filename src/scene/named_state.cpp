#include "pdx/scene/named_state.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/scene/cloud_body.hpp"
#include "pdx/scene/solid.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <stdexcept>

namespace pdx::scene {
namespace {
/// Calls visit(bond term) where particles lie on a lattice.
template <class Visit> void with_bonds(const Standing& scene, Visit&& visit)
{
  if (scene.solid)
    visit(*scene.solid->bonds);
  else if (scene.d && scene.d->bonds)
    visit(*scene.d->bonds);
}

int words_per_particle(const Standing& scene)
{
  return scene.cloud ? scene.cloud->words_per_particle() : kLatticeWords;
}

std::vector<std::uint64_t> gone_in(const Standing& scene)
{
  if (scene.cloud) return scene.cloud->gone();
  std::vector<std::uint64_t> words;
  with_bonds(scene, [&](const auto& bonds) {
    for (const auto& part : bonds.parts()) {
      const std::vector<std::uint64_t> more = part->gone();
      words.insert(words.end(), more.begin(), more.end());
    }
  });
  return words;
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

bool breaks(const Standing& scene) { return scene.model->breaker || (scene.d && scene.d->fracture); }

std::span<const field::RowName> names_with_words(const Standing& scene, const SceneNames& names)
{
  return names.particles().first(breaks(scene) ? names.particles().size() : 0);
}

NamedState what_is_owned(const Standing& scene, const SceneNames& names)
{
  const field::System& system = scene.model->system;
  NamedState state;
  state.dim = system.rows.dim;
  state.rows.assign(names.rows().begin(), names.rows().end());
  state.particles.assign(names.particles().begin(), names.particles().end());
  if (!breaks(scene)) return state;
  state.words_per_particle = words_per_particle(scene);
  state.gone = gone_in(scene);
  if (!scene.d || !scene.d->carried) return state;
  state.carried = gather_all(system.rows.comm, scene.d->carried->broken());
  std::ranges::sort(*state.carried);
  return state;
}
} // namespace

NamedState capture(const Standing& scene) { return what_is_owned(scene, SceneNames(scene)); }

NamedState capture(const Standing& scene, const solve::TimeDriver& driver, const std::optional<CrackNotes>& cracks)
{
  const SceneNames names(scene);
  NamedState state = what_is_owned(scene, names);
  state.in_time = true;
  state.moving = driver.state();
  if (scene.model->touching) state.grips = scene.model->touching->grips();
  if (cracks) state.cracks = named(*cracks, names);
  return state;
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
  for (std::vector<double>* later : {&state.moving.a, &state.moving.held}) later->resize(state.moving.u.size(), 0.0);
}

namespace {
/// What a run has named itself has no name twice.
field::RowMove::Wanted wanted_of(StateMove::From from)
{
  return from == StateMove::From::file ? field::RowMove::Wanted::often : field::RowMove::Wanted::once;
}
} // namespace

StateMove::StateMove(const NamedState& state, const Standing& scene, From from)
    : state_(state), scene_(scene), changed_(from == From::changed), names_(scene),
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
  if (const int width = breaks(scene_) ? words_per_particle(scene_) : 0; state_.words_per_particle != width)
    return {"/gone_bonds", fmt::format("has {} words a particle: must be {}", state_.words_per_particle, width)};
  if (!changed_ && breaks(scene_) && scene_.d && scene_.d->carried && !state_.carried) // else all were particles
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

std::vector<double> StateMove::came_after(std::size_t known) const
{
  std::vector<double> after(state_.rows.size(), 1.0);
  std::fill_n(after.begin(), known, 0.0);
  return rows(after, 1);
}

void StateMove::break_bonds() const
{
  const int width = state_.words_per_particle;
  if (width == 0) return;
  if (scene_.cloud) return scene_.cloud->set_gone(particles_.carry(state_.gone, width));
  const std::vector<std::uint64_t> mine = particles_.carry(state_.gone, width);
  const Torn torn = torn_particles();
  with_bonds(scene_, [&](auto& bonds) {
    auto next = mine.begin();
    for (std::size_t p = 0; p < bonds.parts().size(); ++p) {
      const auto& part = *bonds.parts()[p];
      std::vector<field::RowName> others; // the words of other ranks' particles too
      for (const Index site : part.halo_sites()) others.push_back(names_.particle(static_cast<Index>(p), site));
      const auto end = next + std::ssize(part.sites()) * width;
      std::vector<std::uint64_t> words(next, end);
      next = end;
      const std::vector<std::uint64_t> more = torn.words_of(scene_.model->system.rows.comm, others, width);
      words.insert(words.end(), more.begin(), more.end());
      bonds.set_gone(p, words);
    }
  });
  if (!scene_.d || !scene_.plan) return;
  if (changed_ && state_.carried) break_joined();
  if (scene_.d->carried) scene_.d->carried->set_broken(changed_ ? broken_carried() : *state_.carried);
}

/// Those of the state's particles that lost bonds.
StateMove::Torn StateMove::torn_particles() const
{
  Torn torn;
  const auto width = static_cast<std::size_t>(state_.words_per_particle);
  for (std::size_t k = 0; k < state_.particles.size(); ++k) {
    const auto words = std::span(state_.gone).subspan(k * width, width);
    if (std::ranges::all_of(words, [](std::uint64_t word) { return word == 0; })) continue;
    torn.names.push_back(state_.particles[k]);
    torn.gone.insert(torn.gone.end(), words.begin(), words.end());
  }
  return torn;
}

std::vector<std::uint64_t> StateMove::Torn::words_of(MPI_Comm comm, std::span<const field::RowName> wanted,
                                                     int width) const
{
  if (!any_rank(comm, !wanted.empty())) return {};
  return field::RowMove(comm, names, wanted).carry(gone, width);
}

/// Bonds that left their patch when they broke, and lie in it now.
void StateMove::break_joined() const
{
  pd::BondTerm<2>& bonds = *scene_.d->bonds;
  for (std::size_t p = 0; p < bonds.parts().size(); ++p) {
    std::vector<pd::LatticePart<2>::BondAt> within;
    for (const std::uint64_t key : *state_.carried) {
      const auto bond = couple::lattice_bond(key, scene_.plan->shapes[p].names, bonds.parts()[p]->stencil());
      if (bond && bonds.parts()[p]->active().has(bond->lower) && bonds.parts()[p]->begins(bond->lower, bond->arm))
        within.push_back(*bond);
    }
    if (!within.empty()) bonds.set_gone(p, within);
  }
}

namespace {
std::uint64_t name_of(const pd::LatticePart<2>::BondAt& bond, const geom::SiteNames& names)
{
  return names.of(bond.lower) * pd::kMaxHalfArms + bond.arm;
}
} // namespace

/// Bonds of which some part had broken that elements carried.
std::set<std::uint64_t> StateMove::parted_bonds() const
{
  std::set<std::uint64_t> bonds;
  if (!state_.carried) return bonds;
  for (const std::uint64_t key : *state_.carried)
    for (std::size_t p = 0; p < scene_.plan->shapes.size(); ++p)
      if (const auto bond = couple::lattice_bond(key, scene_.plan->shapes[p].names, scene_.plan->stencils[p])) {
        bonds.insert(name_of(*bond, scene_.plan->shapes[p].names));
        break;
      }
  return bonds;
}

/// Keys of the carried bonds that are broken under another layout: those that were carried then, and those that lay in
/// a patch. Lines are parted elsewhere: of a bond with a broken part no part heals.
std::vector<std::uint64_t> StateMove::broken_carried() const
{
  std::vector<std::uint64_t> keys;
  std::vector<std::size_t> arms;
  std::vector<std::uint64_t> broken = state_.carried.value_or(std::vector<std::uint64_t>{});
  const std::set<std::uint64_t> parted = parted_bonds();
  std::vector<field::RowName> lower; // ends of the bonds
  scene_.d->carried->for_each_key([&](std::uint64_t key, Index patch) {
    const auto p = static_cast<std::size_t>(patch);
    const geom::SiteNames& names = scene_.plan->shapes[p].names;
    const auto [site, arm] = couple::bond_name(key, names, scene_.plan->stencils[p]);
    if (parted.contains(site * pd::kMaxHalfArms + arm)) broken.push_back(key);
    keys.push_back(key);
    arms.push_back(arm);
    lower.push_back(field::RowName::particle(site));
  });
  const std::vector<std::uint64_t> gone =
      torn_particles().words_of(scene_.model->system.rows.comm, lower, state_.words_per_particle);
  for (std::size_t k = 0; k < keys.size(); ++k)
    if (gone[kLatticeWords * k + arms[k] / 64] >> (arms[k] % 64) & 1u) broken.push_back(keys[k]);
  std::ranges::sort(broken);
  return broken;
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
  field::State to{
      rows(from.u, state_.dim), rows(from.v, state_.dim), rows(from.a, state_.dim), rows(from.held, state_.dim), {}};
  if (const auto& steps = scene_.model->system.steps) to.inner = rows(from.inner, steps->width());
  return to;
}

std::optional<CrackNotes> StateMove::cracks() const
{
  if (!state_.cracks) return std::nullopt;
  return placed(*state_.cracks, particles_.carry(state_.cracks->damage, 1), names_);
}
} // namespace pdx::scene
