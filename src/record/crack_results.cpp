#include "pdx/record/crack_results.hpp"

#include "pdx/adapt/energy_trial.hpp"
#include "pdx/law/fracture.hpp"
#include "pdx/solve/static_driver.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace pdx::record {
namespace {
constexpr std::size_t kMostTips = 8; // told in the log

/// A place J is asked for: a tip as it is now, or where the user says (then it belongs to none).
struct Centre {
  crack::Tip tip;
  const CrackEnd* end = nullptr; ///< nearest; null without cracks
  std::optional<std::size_t> number;
};

std::vector<Centre> centres(const Solved& s, const CrackState& state)
{
  std::vector<Centre> list;
  for (std::size_t t = 0; t < state.ends.size(); ++t) {
    list.push_back({state.ends[t].given, &state.ends[t], t});
    list.back().tip.at = state.ends[t].at_farthest();
    list.back().tip.direction = state.ends[t].direction;
  }
  const auto& wanted = s.options.post.j_centre;
  if (!wanted) return list;
  Centre centre;
  const auto distance = [&](const Centre& c) { return (c.tip.at - *wanted).norm(); };
  if (!list.empty()) centre = *std::ranges::min_element(list, {}, distance);
  centre.number.reset();
  centre.tip.at = *wanted;
  return {centre};
}

/// What is asked for of a tip on contours: `j_by_contour`, and `modes_by_contour` with K_I, K_II and T behind the
/// sides. A tip that grew may leave no room for its contours: then there is neither, and `why` says it.
nlohmann::json contour_results(const Solved& s, const Centre& centre, std::span<const double> density, std::string& why)
{
  nlohmann::json results = nlohmann::json::object();
  try {
    const std::vector<post::ContourJ> contours = contour_j(s, centre.tip, density);
    for (const post::ContourJ& contour : contours) results["j_by_contour"].push_back({contour.side, contour.j});
    if (!s.options.post.modes || !centre.end) return results;
    const auto modes = contour_modes(s, centre.tip, side_of(s.d, *centre.end), contours);
    for (std::size_t c = 0; c < modes.size(); ++c)
      results["modes_by_contour"].push_back({contours[c].side, modes[c].opening, modes[c].sliding, modes[c].along});
  } catch (const UserError& error) {
    if (!s.d.fracture) throw;
    why = error.what();
  }
  return results;
}

/// The same over the ring of elements, which a tip that grew may leave no room for either.
nlohmann::json domain_results(const Solved& s, const Centre& centre, std::string& why)
{
  nlohmann::json results = nlohmann::json::object();
  try {
    results["j_domain"] = domain_j(s, centre.tip);
    if (!s.options.post.modes || !centre.end) return results;
    crack::Tip tip = centre.tip;
    if (centre.number) tip.direction = centre.end->direction_over(s.options.post.j_domain->front());
    const post::TipModes modes = domain_modes(s, tip, side_of(s.d, *centre.end));
    results["k1_domain"] = modes.opening;
    results["k2_domain"] = modes.sliding;
    results["t_stress_domain"] = modes.along;
  } catch (const UserError& error) {
    if (!s.d.fracture) throw;
    why = error.what();
  }
  return results;
}

/// The shortest way along a direction from a site of a lattice to another, nearly: a tip that is moved by it stands to
/// the bonds as it did before, and bonds end at sites only. [spacings]
double period(const Vector<2>& direction)
{
  constexpr int longest = 16;
  constexpr double beside = 0.06; // always found: n steps come as near as 1 / (n + 1)
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = -longest; i <= longest; ++i)
    for (int j = -longest; j <= longest; ++j) {
      const Vector<2> way(i, j);
      const double along = direction.dot(way), across = direction.x() * way.y() - direction.y() * way.x();
      if (along > 0.5 && std::abs(across) <= beside) shortest = std::min(shortest, along);
    }
  return shortest;
}

/// What a tip is moved by, either way [m].
double tip_step(const options::SceneOptions& options, const crack::Tip& tip, const geom::Lattice<2>* lattice,
                double element)
{
  if (lattice) return period(tip.direction) * lattice->dx;
  if (tip.direction.cwiseAbs().minCoeff() > 1e-6)
    throw UserError(fmt::format("-post_energy_release: the tip at {} is slanted and ends in elements, where a crack "
                                "closes at edges: put a patch there, or give -post_j_domain",
                                options.frame.text(tip.at)));
  return element;
}

/// Strain energy less work of the loads at full load.
double potential(mesh::Mesh& mesh, const options::SceneOptions& options, const scene::PatchPlan& plan,
                 std::span<const pd::Particle> particles, bool assembled)
{
  mesh.uncover();
  scene::cover_cells(mesh, plan, options.mesh);
  const auto d = scene::discretise(mesh, options, plan, {particles.begin(), particles.end()}, assembled);
  solve::StaticOptions steps;
  steps.load_steps = options.load.steps;
  steps.assembled = assembled;
  solve::StaticDriver driver(d->system, steps);
  const VecHandle u = d->system.rows.vector();
  driver.run(u.get(), [](const solve::Step&, Vec) { return solve::Verdict::go_on; });
  std::vector<double> local;
  d->system.halo->gather(u.get(), local);
  double energy = 0.0;
  for (const auto& term : d->system.terms) energy += term->energy(local);
  for (std::size_t k = 0; k < d->system.load.size(); ++k) energy -= d->system.load[k] * local[k];
  MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, mesh.comm());
  return energy;
}
} // namespace

namespace {
/// J and K over a ring are those of all tips in it.
void require_one_tip(const Solved& s)
{
  const double outer = s.options.post.j_domain->back();
  for (const Centre& centre : centres(s, crack_state(s.d.cracks, s.d.body)))
    for (const crack::Tip& tip : s.d.cracks.tips()) {
      const double far = (tip.at - centre.tip.at).cwiseAbs().maxCoeff();
      if (far > 1e-9 * outer && far < outer && centre.number)
        throw UserError(
            fmt::format("-post_j_domain: the ring to {:g} m around the tip at {} holds the tip at {} too, and J "
                        "and K would be of both: take an outer half-width of {:.6g} m at most",
                        outer, s.options.frame.text(centre.tip.at), s.options.frame.text(tip.at), far));
    }
}

/// The ring must have room around every tip; where cracks grow, around one of them.
void require_ring(const Solved& s)
{
  require_one_tip(s);
  std::optional<UserError> wrong;
  bool any = false;
  for (const Centre& centre : centres(s, crack_state(s.d.cracks, s.d.body))) try {
      (void)domain_j(s, centre.tip);
      any = true;
    } catch (const UserError& error) {
      if (!wrong) wrong = error;
    }
  if (wrong && !(any && s.d.fracture)) throw UserError(*wrong);
}
} // namespace

void require_contours(const Solved& s)
{
  if (s.options.post.j_domain) require_ring(s);
  if (s.options.post.j_contours.empty()) return;
  const std::vector<double> nothing(static_cast<std::size_t>(s.d.system.rows.owned()), 0.0);
  bool any = false;
  for (const Centre& centre : centres(s, crack_state(s.d.cracks, s.d.body))) {
    const auto patch = patch_at(s.plan, centre.tip.at);
    if (!patch) continue;
    any = true;
    (void)contour_j(s, centre.tip, nothing);
    const auto& stencil = s.plan.stencils[*patch];
    const double reach = stencil.reach * stencil.dx;
    for (const double side : s.options.post.j_contours)
      for (const crack::Tip& tip : s.d.cracks.tips()) {
        const Vector<2> off = (tip.at - centre.tip.at).cwiseAbs();
        const double gap = 0.5 * side - off.maxCoeff();
        if (std::abs(gap) <= reach && off.minCoeff() <= 0.5 * side + reach)
          throw UserError(
              fmt::format("-post_j_contours has {:g}: the contour comes within a bond, {:g} m, of the tip at "
                          "{}; choose a side above {:g}",
                          side, reach, s.options.frame.text(tip.at), 2.0 * (off.maxCoeff() + reach)));
      }
  }
  if (!any)
    throw UserError("-post_j_contours lie in a patch, but no crack's tip (and no -post_j_centre) does: give "
                    "-post_j_domain for elements");
}

std::vector<std::string> tip_lines(const nlohmann::json& results)
{
  std::vector<std::string> lines;
  if (!results.contains("tips")) return lines;
  const auto middle = [](const nlohmann::json& contours) { return contours.at(contours.size() / 2); };
  for (const nlohmann::json& tip : results.at("tips")) {
    const bool ring = tip.contains("j_domain");
    if (!ring && !tip.contains("j_by_contour")) continue;
    if (lines.size() == kMostTips) {
      lines.emplace_back("J at more tips: tips in results of summary.json");
      break;
    }
    std::string line = fmt::format("tip at ({:.6g}, {:.6g}): J {:.5g} J/m^2", tip.at("at").at(0).get<double>(),
                                   tip.at("at").at(1).get<double>(),
                                   (ring ? tip.at("j_domain") : middle(tip.at("j_by_contour")).at(1)).get<double>());
    if (ring && tip.contains("k1_domain"))
      line += fmt::format(", K_I {:.5g}, K_II {:.5g} Pa m^0.5", tip.at("k1_domain").get<double>(),
                          tip.at("k2_domain").get<double>());
    else if (!ring && tip.contains("modes_by_contour"))
      line += fmt::format(", K_I {:.5g}, K_II {:.5g} Pa m^0.5", middle(tip.at("modes_by_contour")).at(1).get<double>(),
                          middle(tip.at("modes_by_contour")).at(2).get<double>());
    lines.push_back(line);
  }
  return lines;
}

std::vector<double> energy_release(mesh::Mesh& mesh, const options::SceneOptions& options, const scene::PatchPlan& plan,
                                   std::span<const pd::Particle> particles, bool assembled)
{
  if (options.fracture.active())
    throw UserError(
        "-post_energy_release moves the given tips, but with a toughness they move by themselves: drop one");
  const crack::CrackSet cracks(options.cracks.lines, options.mesh.file.empty() ? plan.body : mesh.bounds());
  const double element = std::sqrt(mesh.bounds().size().prod() / mesh.global_cells());
  std::vector<double> rates;
  for (const crack::Tip& tip : cracks.tips()) {
    const auto patch = patch_at(plan, tip.at);
    const double step = tip_step(options, tip, patch ? &plan.shapes[*patch].lattice : nullptr, element);
    if (patch_at(plan, tip.at - step * tip.direction) != patch ||
        patch_at(plan, tip.at + step * tip.direction) != patch)
      throw UserError(fmt::format("-post_energy_release moves the tip at {} by {:g} m to either side, across "
                                  "the border of a patch: move the patch or leave it out",
                                  options.frame.text(tip.at), step));
    double change = 0.0;
    for (const double sign : {1.0, -1.0}) {
      options::SceneOptions moved = options;
      crack::Polyline& line = moved.cracks.lines[static_cast<std::size_t>(tip.crack)];
      (tip.last ? line.back() : line.front()) += sign * step * tip.direction;
      change += sign * potential(mesh, moved, plan, particles, assembled);
    }
    rates.push_back(-change / (2.0 * step * options.elastic.thickness));
  }
  mesh.uncover();
  return rates;
}

std::string add_crack_results(const Solved& s, const CrackState& state, std::span<const double> release,
                              nlohmann::json& results)
{
  std::string why;
  nlohmann::json tips = nlohmann::json::array();
  const auto place = [&s](const Vector<2>& x) {
    const Vector<2> given = s.options.frame.given<2>(x);
    return nlohmann::json{given[0], given[1]};
  };
  for (std::size_t t = 0; t < state.ends.size(); ++t) {
    const CrackEnd& end = state.ends[t];
    results["crack_tips"].push_back(place(end.tip()));
    nlohmann::json tip{{"start", place(end.given.at)},
                       {"at", place(end.tip())},
                       {"grown", end.grown},
                       {"farthest_broken", end.farthest_broken}};
    if (std::isfinite(end.first_intact)) tip["first_intact"] = end.first_intact;
    if (end.grown > 0.0) tip["angle_degrees"] = end.angle_degrees();
    if (t < release.size()) tip["energy_release_rate"] = release[t];
    tips.push_back(tip);
  }
  if (!s.d.cracks.empty()) results["crack_length"] = state.length;
  if (!release.empty()) results["energy_release_rate"] = release.front();

  std::vector<double> density;
  if (s.d.bonds && !s.options.post.j_contours.empty()) density = adapt::energy_density(s.d.view(s.mesh), s.u);
  const auto add = [&](const Centre& centre, const nlohmann::json& found) { // at the top level of the first of its kind
    for (const auto& [key, value] : found.items()) {
      if (centre.number) tips[*centre.number][key] = value;
      if (!results.contains(key)) results[key] = value;
    }
  };
  for (const Centre& centre : centres(s, state)) {
    const nlohmann::json on_contours = density.empty() ? nlohmann::json() : contour_results(s, centre, density, why);
    if (on_contours.contains("j_by_contour") && !results.contains("j_integral")) { // of the first tip in a patch
      const nlohmann::json& contours = on_contours["j_by_contour"];
      const double middle = contours[contours.size() / 2][1];
      results["j_integral"] = middle;
      results["stress_intensity"] = law::stress_intensity(middle, s.options.elastic);
    }
    add(centre, on_contours);
    if (!s.options.post.j_domain) continue;
    const nlohmann::json on_ring = domain_results(s, centre, why);
    if (on_ring.contains("j_domain") && !results.contains("j_domain") && !results.contains("j_integral"))
      results["stress_intensity"] = law::stress_intensity(on_ring["j_domain"], s.options.elastic);
    add(centre, on_ring);
  }
  if (!tips.empty()) results["tips"] = tips;
  return why;
}
} // namespace pdx::record
