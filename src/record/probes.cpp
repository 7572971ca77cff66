#include "pdx/record/probes.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/shown.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>
#include <set>

namespace pdx::record {
namespace {
constexpr const char* kVelocityField = "velocity";

/// Components of a field that say something in so many dimensions, by their place among those that are stored.
std::vector<std::size_t> shown_components(std::size_t stored, int dim)
{
  if (stored == 3 && dim == 2) return {0, 1};
  if (stored == 6 && dim == 2) return {0, 1, 3};
  std::vector<std::size_t> all(stored);
  for (std::size_t k = 0; k < stored; ++k) all[k] = k;
  return all;
}

std::string component_name(std::size_t stored, std::size_t k)
{
  static constexpr const char* vectors[] = {"_x", "_y", "_z"};
  static constexpr const char* tensors[] = {"_xx", "_xy", "_xz", "_yy", "_yz", "_zz"};
  return stored == 1 ? "" : stored == 3 ? vectors[k] : tensors[k];
}

std::string unit_of(std::span<const field::OutputBlock> blocks, const std::string& name)
{
  for (const field::OutputBlock& block : blocks)
    for (const field::OutputField& field : block.fields)
      if (const std::size_t open = field.name.find(" [");
          field.name.substr(0, open) == name && open != std::string::npos)
        return field.name.substr(open + 2, field.name.size() - open - 3);
  return name == kVelocityField ? "m/s" : "-";
}

std::string names_of(std::span<const field::OutputBlock> blocks)
{
  std::set<std::string> names{kVelocityField};
  for (const field::OutputBlock& block : blocks)
    for (const field::OutputField& field : block.fields)
      if (!field.on_cells) names.insert(field.name.substr(0, field.name.find(" [")));
  return fmt::format("{}", fmt::join(names, ", "));
}

bool has(std::span<const field::OutputBlock> blocks, const std::string& name)
{
  return std::ranges::any_of(blocks, [&](const field::OutputBlock& block) {
    return std::ranges::any_of(block.fields, [&](const field::OutputField& field) {
      return !field.on_cells && field.name.substr(0, field.name.find(" [")) == name;
    });
  });
}

std::size_t stored_components(std::span<const field::OutputBlock> blocks, const std::string& name)
{
  for (const field::OutputBlock& block : blocks)
    for (const field::OutputField& field : block.fields)
      if (field.name.substr(0, field.name.find(" [")) == name) return static_cast<std::size_t>(field.rank);
  return 3;
}

std::string place_text(const options::ProbeOptions& probe, std::size_t k, int dim)
{
  const Vector<3>& x = probe.places[k];
  return fmt::format("({:.10g})", fmt::join(x.data(), x.data() + dim, ", "));
}
} // namespace

Probes::Pictures Probes::pictures(const Probed& scene) const
{
  const bool moves = std::ranges::any_of(options_, [](const options::ProbeOptions& probe) {
    return std::ranges::find(probe.fields, kVelocityField) != probe.fields.end();
  });
  Pictures now{scene.blocks(false), {}};
  const bool some = std::ranges::any_of(now.still, [](const field::OutputBlock& block) {
    return !has({&block, 1}, kVelocityField); // points have it, elements and particles beside them not
  });
  if (moves && some) now.moving = scene.blocks(true);
  return now;
}

void Probes::find(const Probed& scene, const options::ProbeOptions& probe, State& state, const Pictures& now) const
{
  if (!state.hosts.empty()) return;
  for (const Vector<3>& place : probe.places) {
    const Vector<3> x = scene.frame.inside(place);
    state.hosts.push_back(
        probe_host(scene.comm, now.still, scene.dim == 2 ? Vector<3>(x[0], x[1], 0.0) : x, scene.spacing));
    if (state.hosts.back() && state.hosts.back()->distance > scene.reach) state.hosts.back().reset();
  }
}

std::vector<double> Probes::value(const Probed& scene, const ProbeHost& host, const std::string& field,
                                  const Pictures& now) const
{
  std::vector<double> known = probe_value(scene.comm, now.still, host, field);
  if (!known.empty() || field != kVelocityField || now.moving.empty()) return known;
  return probe_value(scene.comm, now.moving, host, "displacement");
}

void Probes::open(const Probed& scene, const options::ProbeOptions& probe, State& state, const Pictures& now,
                  std::optional<double> keep_to)
{
  std::vector<io::Column> columns{{"step", "-"}, time_};
  if (probe.line) columns.push_back({"along", "m"});
  for (const std::string& field : probe.fields) {
    const bool moving = field == kVelocityField && !has(now.still, kVelocityField);
    if (!moving && !has(now.still, field))
      throw UserError(fmt::format("-probe_{}_field is {}: the scene has no such field; it has {}", probe.name,
                                  shown(field), names_of(now.still)));
    const std::size_t stored = stored_components(now.still, moving ? "displacement" : field);
    state.components.push_back(stored);
    for (const std::size_t k : shown_components(stored, scene.dim))
      columns.push_back({field + component_name(stored, k), unit_of(now.still, field)});
  }
  for (std::size_t k = 0; k < probe.places.size(); ++k)
    if (!state.hosts[k])
      throw UserError(fmt::format("-probe_{}_{} has {}: no element and no particle is there", probe.name,
                                  probe.line ? "line" : "at", place_text(probe, k, scene.dim)));
  const std::filesystem::path path = directory_ / fmt::format("probe_{}.csv", probe.name);
  int there = std::filesystem::exists(path);
  MPI_Bcast(&there, 1, MPI_INT, 0, scene.comm);
  state.file = std::make_unique<io::Curve>(scene.comm, path, columns, there ? keep_to : std::nullopt);
}

void Probes::write(const Probed& scene, const options::ProbeOptions& probe, State& state, const Pictures& now,
                   double time)
{
  for (std::size_t place = 0; place < probe.places.size(); ++place) {
    std::vector<double> row{static_cast<double>(state.written), time};
    if (probe.line) row.push_back((probe.places[place] - probe.places[0]).norm());
    for (std::size_t f = 0; f < probe.fields.size(); ++f) {
      const std::vector<std::size_t> shown = shown_components(state.components[f], scene.dim);
      const std::optional<ProbeHost>& host = state.hosts[place];
      const std::vector<double> all = host ? value(scene, *host, probe.fields[f], now) : std::vector<double>{};
      for (const std::size_t k : shown)
        row.push_back(k < all.size() ? all[k] : std::numeric_limits<double>::quiet_NaN());
    }
    state.file->row(row);
  }
}

void Probes::begin(const Probed& scene, int step, double time, std::optional<double> keep_to)
{
  if (options_.empty()) return;
  const Pictures now = pictures(scene);
  for (std::size_t p = 0; p < options_.size(); ++p) {
    find(scene, options_[p], states_[p], now);
    open(scene, options_[p], states_[p], now, keep_to);
    states_[p].written = step;
    if (!keep_to) write(scene, options_[p], states_[p], now, time);
  }
}

bool Probes::due(int step, bool all) const
{
  for (std::size_t p = 0; p < options_.size(); ++p)
    if (states_[p].written != step && (all || step % options_[p].every == 0)) return true;
  return false;
}

void Probes::look(const Probed& scene, int step, double time, bool all)
{
  if (!due(step, all)) return;
  const Pictures now = pictures(scene);
  for (std::size_t p = 0; p < options_.size(); ++p) {
    State& state = states_[p];
    if (state.written == step || !(all || step % options_[p].every == 0)) continue;
    find(scene, options_[p], state, now);
    state.written = step;
    write(scene, options_[p], state, now, time);
  }
}

void Probes::forget_hosts()
{
  for (State& state : states_) state.hosts.clear();
}

void Probes::close()
{
  for (State& state : states_)
    if (state.file) state.file->close();
}
} // namespace pdx::record
