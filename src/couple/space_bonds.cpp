#include "pdx/couple/space_bonds.hpp"

#include "pdx/base/events.hpp"
#include "pdx/couple/face_trace.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::couple {
namespace space_bonds {
Site<3> stepped(Site<3> site, const Site<3>& step, int sign)
{
  for (std::size_t d = 0; d < 3; ++d) site[d] += sign * step[d];
  return site;
}

/// A bond before the rows of particles of other ranks are known.
struct Draft {
  Index site = -1; // the end `a` is that particle; -1: it is carried too
  PetscInt row = -1;
  Index a = -1, b = -1;
  CarriedBond<3> bond;
};

/// Writes the drafts of one body, in order of sites, and the points that nodes carry.
class Drafter {
public:
  using Part = pd::LatticePart<3>;
  Drafter(const field::Rows& rows, const CouplingOptions& options, Part& part, const SpaceShape& shape,
          const NodeRows& nodes, CarriedPoints<3>& points)
      : rows_(rows), options_(options), part_(part), shape_(shape), nodes_(nodes), points_(points),
        exists_(family_of(shape, family_sight(part.stencil())))
  {
    for (const pd::Arm<3>& arm : part.stencil().half)
      lines_.push_back({geom::pieces_of_line<3>(stepped({0, 0, 0}, arm.step, -1)), geom::pieces_of_line<3>(arm.step)});
    const Index reach = part.stencil().reach;
    const geom::SiteSet<3>& active = part.active();
    Site<3> lower = active.lower(), extent{};
    for (std::size_t d = 0; d < 3; ++d) {
      lower[d] -= reach;
      extent[d] = active.upper()[d] - lower[d] + reach;
    }
    factors_ = part.take_factors(lower, extent);
    find_mine();
  }

  std::vector<Draft> write()
  {
    for_each_border_site([&](const Site<3>& site) {
      if (part_.active().has(site)) leave_from(site);
    });
    for_each_border_site([&](const Site<3>& site) { clip_from(site); });
    return std::move(drafts_);
  }

private:
  /// Sites from which bonds may reach a node of this rank.
  void find_mine()
  {
    const Index ratio = shape_.of->material.ratio, far = part_.stencil().reach + ratio + 1;
    for (const auto& [node, row] : nodes_) {
      if (!rows_.owns(row)) continue;
      for (std::size_t d = 0; d < 3; ++d) {
        mine_lower_[d] = std::min(any_mine_ ? mine_lower_[d] : node[d] * ratio - far, node[d] * ratio - far);
        mine_upper_[d] = std::max(any_mine_ ? mine_upper_[d] : node[d] * ratio + far, node[d] * ratio + far);
      }
      any_mine_ = true;
    }
  }
  bool near_mine(const Site<3>& site) const
  {
    for (std::size_t d = 0; d < 3; ++d)
      if (site[d] < mine_lower_[d] || site[d] > mine_upper_[d]) return false;
    return any_mine_;
  }

  /// Sites whose bonds may meet the border: on either side, in order.
  template <class Visit> void for_each_border_site(Visit&& visit) const
  {
    const Index reach = part_.stencil().reach;
    const geom::SiteSet<3>& active = part_.active();
    const geom::SiteSet<3> deep = active.eroded(reach), near = active.grown(reach);
    for (Site<3> site = near.lower(); site[2] < near.upper()[2]; ++site[2])
      for (site[1] = near.lower()[1]; site[1] < near.upper()[1]; ++site[1])
        for (site[0] = near.lower()[0]; site[0] < near.upper()[0]; ++site[0]) {
          if (deep.has(site)) site[0] = deep.end_of_run(site); // jump over the inside
          if (near.has(site)) visit(std::as_const(site));
        }
  }

  bool bonded(const Site<3>& site) const { return part_.active().has(site) || exists_(site); }

  double surface_factor(const Site<3>& site, std::size_t arm, int sign) const
  {
    if (!factors_.of) return 1.0;
    const Site<3> lower = sign > 0 ? site : stepped(site, part_.stencil().half[arm].step, -1);
    return factors_.any(lower) ? factors_.of(lower, arm) : 1.0;
  }

  /// As in the plane.
  ///@{
  Index zone() const { return factors_.even_over; }
  std::uint64_t key(const Site<3>& site, std::size_t arm, int sign, int part) const
  {
    const std::uint64_t bond = (shape_.names.of(site) * pd::kMaxHalfArms + arm) * 2 + (sign > 0);
    return bond * kPartsOfBonds + static_cast<std::uint64_t>(part);
  }
  ///@}

  bool mine(const Host& host) const
  {
    for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k)
      if (rows_.owns(host.rows[k])) return true;
    return false;
  }

  /// In spacings, a part of the way along a bond.
  static Vector<3> on_way(const Site<3>& site, const Site<3>& step, double way)
  {
    Vector<3> x;
    for (std::size_t d = 0; d < 3; ++d) x[static_cast<Eigen::Index>(d)] = site[d] + 0.5 + way * step[d];
    return x;
  }

  void judge_no_fail(const Site<3>& a, const Site<3>& b, CarriedBond<3>& bond) const
  {
    for (const geom::Box<2>& box : options_.no_fail)
      for (const Site<3>& end : {a, b})
        bond.no_fail = bond.no_fail || box.contains(part_.lattice().point(end).head<2>());
  }

  /// Bonds from a particle that leave the patch, up to where they do.
  void leave_from(const Site<3>& site)
  {
    const Index row = part_.row(site);
    const bool own = row >= 0 && row < rows_.owned();
    if (!own && !near_mine(site)) return;
    const pd::Stencil<3>& stencil = part_.stencil();
    for (std::size_t h = 0; h < stencil.half.size(); ++h)
      for (const int sign : {+1, -1}) {
        const pd::Arm<3>& arm = stencil.half[h];
        const Site<3> other = stepped(site, arm.step, sign), step = stepped({0, 0, 0}, arm.step, sign);
        const auto& line = lines_[h][sign > 0];
        if (geom::runs_inside<3>(part_.active(), site, line) || !bonded(other)) continue;
        const auto out = std::ranges::find_if(
            line, [&](const auto& piece) { return !part_.active().has(geom::cell_at<3>(site, piece)); });
        const double leave = std::prev(out)->leave;
        const std::optional<Host> face =
            face_host(shape_, nodes_, zone(), on_way(site, step, leave), geom::cell_at<3>(site, *std::prev(out)),
                      geom::cell_at<3>(site, *out));
        if (!face || (!own && !mine(*face))) continue;
        Draft draft;
        draft.site = part_.number(site);
        draft.row = own ? rows_.first + row : -1;
        draft.b = points_.add(*face);
        draft.bond.key = key(site, h, sign, 0);
        draft.bond.kappa = arm.kappa * surface_factor(site, h, sign);
        draft.bond.xi = leave * sign * arm.xi;
        draft.bond.from = part_.lattice().point(site).head<2>();
        draft.bond.energy_share = arm.length / stencil.volume();
        draft.bond.volume = arm.volume_share * stencil.volume();
        judge_no_fail(site, other, draft.bond);
        drafts_.push_back(draft);
      }
  }

  /// Bonds with a part in the patch that ends at the border on both sides.
  void clip_from(const Site<3>& site)
  {
    const geom::SiteSet<3>& active = part_.active();
    if ((active.is_box() && active.has(site)) || !near_mine(site) || !bonded(site)) return;
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h) {
      const auto& line = lines_[h][1];
      if (!geom::comes_in<3>(active, site, line)) continue;
      const Site<3> other = stepped(site, part_.stencil().half[h].step, 1);
      if ((active.is_box() && active.has(other)) || !bonded(other)) continue;
      for (const geom::PartInside& part : geom::parts_inside<3>(active, site, line))
        if (part.clip.enter > 0.0 && (part.clip.leave < 1.0 || !active.has(other))) clip(site, other, h, part);
    }
  }

  void clip(const Site<3>& site, const Site<3>& other, std::size_t h, const geom::PartInside& part)
  {
    const pd::Arm<3>& arm = part_.stencil().half[h];
    const auto& line = lines_[h][1];
    const auto first = static_cast<std::size_t>(part.first);
    std::size_t behind = first; // the piece after the last inside
    while (part_.active().has(geom::cell_at<3>(site, line[behind]))) ++behind;
    const auto face = [&](double way, std::size_t inner, std::size_t beyond) {
      return face_host(shape_, nodes_, zone(), on_way(site, arm.step, way), geom::cell_at<3>(site, line[inner]),
                       geom::cell_at<3>(site, line[beyond]));
    };
    const auto enter = face(part.clip.enter, first, first - 1), leave = face(part.clip.leave, behind - 1, behind);
    if (!enter || !leave || (!mine(*enter) && !mine(*leave))) return;
    Draft draft;
    draft.bond.key = key(site, h, 1, part.first + 1);
    draft.bond.kappa = arm.kappa * surface_factor(site, h, 1);
    draft.bond.xi = (part.clip.leave - part.clip.enter) * arm.xi;
    draft.bond.from = (part_.lattice().point(site) + part.clip.enter * arm.xi).head<2>();
    judge_no_fail(site, other, draft.bond);
    draft.a = points_.add(*enter);
    draft.b = points_.add(*leave);
    drafts_.push_back(draft);
  }

  const field::Rows& rows_;
  const CouplingOptions& options_;
  const Part& part_;
  const SpaceShape& shape_;
  const NodeRows& nodes_;
  CarriedPoints<3>& points_;
  pd::Exists<3> exists_;
  std::vector<std::array<std::vector<geom::LinePiece<3>>, 2>> lines_; // per half arm, backwards and along it
  pd::BondFactors<3> factors_;
  bool any_mine_ = false;
  Site<3> mine_lower_{}, mine_upper_{};
  std::vector<Draft> drafts_;
};

/// Finds the rows of particles of other ranks. Collective.
void complete(std::vector<Draft>& drafts, const pd::LatticePart<3>& part)
{
  std::vector<Index> sites;
  for (const Draft& draft : drafts)
    if (draft.site >= 0 && draft.row < 0) sites.push_back(draft.site);
  const std::vector<PetscInt> rows = part.directory().rows(sites);
  std::size_t next = 0;
  for (Draft& draft : drafts)
    if (draft.site >= 0 && draft.row < 0) draft.row = rows[next++];
}
} // namespace space_bonds

Index family_sight(const pd::Stencil<3>& stencil) { return 2 * pd::family_reach<3>(stencil); }

pd::Exists<3> family_of(const SpaceShape& shape, Index reach)
{
  return [&shape, reach](const Site<3>& site) {
    if (shape.where.active.has(site) || shape.of->has(site)) return true;
    const Site<3>& count = shape.where.lattice.count;
    for (std::size_t d = 0; d < 3; ++d) {
      if (site[d] >= 0 && site[d] < count[d]) continue;
      // The end of the body there, as wide as a family: no particle may lie at it.
      const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
      Site<3> at{};
      at[d] = site[d] < 0 ? 0 : count[d] - 1;
      const auto near = [&](std::size_t a) { return std::clamp(site[a], 0, count[a] - 1); };
      if (at[e] = near(e), at[f] = near(f); !shape.has_point(at)) return false;
      for (at[e] = near(e) - reach; at[e] <= near(e) + reach; ++at[e])
        for (at[f] = near(f) - reach; at[f] <= near(f) + reach; ++at[f])
          if (shape.where.active.has(at)) return false;
    }
    // Within the box around a body there is nothing behind what it has.
    return std::ranges::any_of(std::array{0U, 1U, 2U},
                               [&](std::size_t d) { return site[d] < 0 || site[d] >= count[d]; });
  };
}

std::unique_ptr<CarriedBonds<3>> carry_bonds(const field::Rows& rows, const CouplingOptions& options,
                                             std::span<const std::unique_ptr<pd::LatticePart<3>>> parts,
                                             std::span<const SpaceShape> shapes, std::span<const NodeRows> nodes)
{
  static Event event("couple_bonds");
  const Timed timed(event);
  CarriedPoints<3> points;
  std::vector<CarriedBond<3>> bonds;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::vector<space_bonds::Draft> drafts =
        space_bonds::Drafter(rows, options, *parts[p], shapes[p], nodes[p], points).write();
    space_bonds::complete(drafts, *parts[p]);
    bonds.reserve(bonds.size() + drafts.size());
    PetscInt last_row = -1;
    Index last_point = -1;
    for (space_bonds::Draft& draft : drafts) {
      CarriedBond<3>& bond = draft.bond;
      bond.patch = static_cast<Index>(p);
      bond.a = draft.a;
      if (draft.site >= 0) {
        if (draft.row != last_row) last_point = points.add(Host::of_row(draft.row));
        last_row = draft.row;
        bond.a = last_point;
      }
      bond.b = draft.b;
      bond.force_a = bond.a;
      bond.force_b = bond.b;
      bonds.push_back(bond);
    }
  }
  return std::make_unique<CarriedBonds<3>>(rows, std::move(points), std::move(bonds), options.kinematics, true);
}

std::optional<pd::LatticePart<3>::BondAt> lattice_bond(std::uint64_t key, const geom::SpaceNames& names,
                                                       const pd::Stencil<3>& stencil)
{
  const std::uint64_t bond = key / kPartsOfBonds;
  const auto arm = static_cast<std::size_t>(bond / 2 % pd::kMaxHalfArms);
  const std::optional<Site<3>> site = names.site(bond / 2 / pd::kMaxHalfArms);
  if (!site || arm >= stencil.half.size()) return std::nullopt;
  return pd::LatticePart<3>::BondAt{bond % 2 ? *site : space_bonds::stepped(*site, stencil.half[arm].step, -1), arm};
}

BondName bond_name(std::uint64_t key, const geom::SpaceNames& names, const pd::Stencil<3>& stencil)
{
  const auto bond = lattice_bond(key, names, stencil);
  if (!bond) throw std::logic_error("a bond is not of the body it is said to be of");
  return {names.of(bond->lower), bond->arm};
}
} // namespace pdx::couple
