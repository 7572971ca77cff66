#include "pdx/record/tip_j.hpp"

#include "pdx/adapt/energy_trial.hpp"
#include "pdx/law/fracture.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <ranges>

namespace pdx::record {
namespace {
constexpr double kProlonged = 1e-3; // of the body's size, as `crack::CrackSet` has it

/// Corner values of either side of a cut element.
void parts_of(const Solved& s, const xfem::CutElement& cut, std::vector<post::PartOfCell>& parts)
{
  const field::RowHalo& halo = *s.d.system.halo;
  const auto value = [&](PetscInt row) {
    const auto at = 2 * static_cast<std::size_t>(halo.local(row));
    return Vector<2>(s.u[at], s.u[at + 1]);
  };
  for (const xfem::Side side : xfem::kSides) {
    post::PartOfCell part{cut.element.cell.points(side), fem::ElementVector::Zero()};
    for (std::size_t a = 0; a < 4; ++a) {
      Vector<2> corner = value(s.d.node_rows[static_cast<std::size_t>(s.mesh.cell(cut.cell)[a])]);
      if (const double factor = xfem::set_factor(cut, a, side); factor != 0.0) corner += factor * value(cut.sets[a]);
      part.corner_values.segment<2>(static_cast<Eigen::Index>(2 * a)) = corner;
    }
    parts.push_back(part);
  }
}

/// The elements of a scene, as integrals over a ring of them see them.
struct Elements {
  explicit Elements(const Solved& s)
      : body{s.mesh, s.options.elastic, s.options.element_kinematics()}, ring{(*s.options.post.j_domain)[0],
                                                                              (*s.options.post.j_domain)[1],
                                                                              s.options.frame},
        u(s.d.node_field->displacement(s.u)), parts([&s](Index cell, std::vector<post::PartOfCell>& into) {
          for (const xfem::CutElement& cut : s.d.sets->all_of(cell)) parts_of(s, cut, into);
        })
  {}
  fem::ElasticBody body;
  post::DomainRing ring;
  std::vector<double> u;
  post::CellParts parts;
};

/// J on the contours of the options for another displacement, of the patch that holds the tip.
std::vector<post::ContourJ> contours_of(const Solved& s, std::size_t patch, const crack::Tip& tip,
                                        std::span<const double> u, std::span<const double> density)
{
  const pd::LatticePart<2>& part = *s.d.bonds->parts()[patch];
  std::vector<post::SquareContour> contours;
  for (const double side : s.options.post.j_contours) contours.push_back({tip.at, side});
  const post::PatchState state{
      s.mesh.comm(),  part, s.options.bond_kinematics(), u, density, s.d.carried ? part.stencil().reach : 1,
      s.options.frame};
  return post::nonlocal_j(state, tip.direction, contours);
}
} // namespace

std::optional<std::size_t> patch_at(const scene::PatchPlan& plan, const Vector<2>& x)
{
  for (std::size_t p = 0; p < plan.shapes.size(); ++p)
    if (plan.shapes[p].holds(x, 1e-6 * plan.shapes[p].lattice.dx)) return p;
  return std::nullopt;
}

std::vector<post::ContourJ> contour_j(const Solved& s, const crack::Tip& tip, std::span<const double> density)
{
  const auto patch = patch_at(s.plan, tip.at);
  if (!patch || !s.d.bonds) return {};
  return contours_of(s, *patch, tip, s.u, density);
}

std::vector<post::TipModes> contour_modes(const Solved& s, const crack::Tip& tip, const post::SideOfCrack& side,
                                          std::span<const post::ContourJ> contours)
{
  const auto patch = patch_at(s.plan, tip.at);
  if (!patch || contours.empty()) return {};
  double most = 0.0;
  for (const post::ContourJ& contour : contours) most = std::max(most, std::abs(contour.j));
  if (most == 0.0) return std::vector<post::TipModes>(contours.size(), post::TipModes{}); // nothing moves
  const std::size_t owned = 2 * static_cast<std::size_t>(s.d.system.rows.owned());
  return post::contour_modes(*s.d.bonds->parts()[*patch], owned, s.options.elastic, tip,
                             std::sqrt(most * law::crack_modulus(s.options.elastic)), side,
                             [&](std::span<const double> added) {
                               std::vector<double> u(s.u.begin(), s.u.end());
                               for (std::size_t k = 0; k < added.size(); ++k) u[k] += added[k];
                               s.d.system.halo->refresh(u);
                               return contours_of(s, *patch, tip, u, adapt::energy_density(s.d.view(s.mesh), u));
                             });
}

double domain_j(const Solved& s, const crack::Tip& tip)
{
  const Elements e(s);
  return post::domain_j(e.body, tip, e.ring, e.u, e.parts);
}

post::TipModes domain_modes(const Solved& s, const crack::Tip& tip, const post::SideOfCrack& side)
{
  const Elements e(s);
  return post::domain_modes(e.body, tip, e.ring, e.u, side, e.parts);
}

post::SideOfCrack side_of(const scene::Discretisation& d, const CrackEnd& end)
{
  crack::Polyline line = d.cracks.points(end.given.crack);
  if (!end.given.last) std::ranges::reverse(line);
  const auto given = std::ranges::min_element(line, {}, [&](const Vector<2>& x) { return (x - end.given.at).norm(); });
  line.erase(given + 1, line.end());
  line.insert(line.end(), end.path.begin() + 1, end.path.end());
  if (!end.given.last) std::ranges::reverse(line); // as it was: a place on the crack counts as left of that
  const auto everywhere = [](const Vector<2>&) { return true; };
  // Both ends are inside, so nothing is prolonged, but the shift that decides about what lies on the crack goes by
  // this.
  const double prolong = kProlonged * d.body.size().maxCoeff();
  auto crack = std::make_shared<const crack::CrackSet>(std::vector<crack::Polyline>{line}, everywhere, prolong);
  return [crack, sign = end.given.last ? 1 : -1](const Vector<2>& x) { return sign * crack->side(0, x); };
}

std::vector<std::optional<post::TipModes>> modes_of_tips(const Solved& s, const CrackState& state)
{
  std::vector<double> density;
  if (s.d.bonds && !s.options.post.j_domain) density = adapt::energy_density(s.d.view(s.mesh), s.u);
  std::vector<std::optional<post::TipModes>> modes;
  for (const CrackEnd& end : state.ends) {
    crack::Tip tip = end.given;
    tip.at = end.at_farthest();
    tip.direction = end.direction;
    modes.emplace_back();
    try {
      if (s.options.post.j_domain) {
        tip.direction = end.direction_over(s.options.post.j_domain->front()); // as the ring sees the crack
        modes.back() = domain_modes(s, tip, side_of(s.d, end));
        continue;
      }
      const auto all = contour_modes(s, tip, side_of(s.d, end), contour_j(s, tip, density));
      if (!all.empty()) modes.back() = all[all.size() / 2];
    } catch (const UserError&) { // grown to where they do not fit
      if (!s.d.fracture) throw;
    }
  }
  return modes;
}
} // namespace pdx::record
