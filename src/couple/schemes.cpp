#include "pdx/couple/schemes.hpp"

#include "pdx/base/events.hpp"
#include "pdx/geom/clip.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::couple {
namespace {
using Part = pd::LatticePart<2>;
constexpr double kTouch = 1e-9; // of the acting part of a bond, at either end

Site<2> stepped(Site<2> site, const Site<2>& step, int sign)
{
  site[0] += sign * step[0];
  site[1] += sign * step[1];
  return site;
}

/// A bond before the rows of particles of other ranks are known. `site` >= 0: the end `a` is that particle.
struct Draft {
  Index site = -1;
  PetscInt row = -1; // global row of the particle, -1 while unknown
  Host a, b, force_a, force_b;
  Vector<2> xi;
  double kappa = 0.0, energy_share = 0.0, volume = 0.0;
  bool cut = false, no_fail = false;
  std::uint64_t key = 0; // within its patch
};
constexpr int kPatchBit = 48; // of a bond's key, from which on it has the number of its patch

/// Writes the drafts of one patch, in order of sites.
class Drafter {
public:
  Drafter(const field::Rows& rows, const CouplingOptions& options, const Part& part, const Surroundings& around)
      : rows_(rows), options_(options), part_(part), around_(around),
        exists_(family_of(around, part.stencil(), options.scheme)),
        mine_(around.edges_of_rows(rows.first, rows.first + rows.owned()))
  {
    if (!part.correction()) return;
    const Index reach = part.stencil().reach; // bonds that clip a corner start and end outside
    const auto& count = part.lattice().count;
    factors_ = part.correction()({part.lattice(), {-reach, -reach}, {count[0] + 2 * reach, count[1] + 2 * reach}});
  }

  std::vector<Draft> write()
  {
    refuse_homeless_ghosts();
    for_each_ring_site(part_.stencil().reach, true, [&](const Site<2>& site) { leave_from(site); });
    if (options_.scheme != Scheme::ghost)
      for_each_ring_site(part_.stencil().reach, false, [&](const Site<2>& site) { clip_from(site); });
    return std::move(drafts_);
  }

private:
  /// Sites within `width` of the border, on the inner or the outer side.
  template <class Visit> void for_each_ring_site(Index width, bool inner, Visit&& visit) const
  {
    const auto& count = part_.lattice().count;
    const Index pad = inner ? 0 : width, hole = inner ? width : 0;
    for (Site<2> site{0, -pad}; site[1] < count[1] + pad; ++site[1])
      for (site[0] = -pad; site[0] < count[0] + pad; ++site[0]) {
        if (site[1] >= hole && site[1] < count[1] - hole && site[0] == hole && count[0] > 2 * hole)
          site[0] = count[0] - hole; // jump over the inside
        if (site[0] < count[0] + pad) visit(site);
      }
  }

  void refuse_homeless_ghosts() const
  {
    if (options_.scheme == Scheme::energy) return;
    for_each_ring_site(part_.stencil().reach, false, [&](const Site<2>& site) {
      if (!around_.outside(site) || around_.element_host(site).count) return;
      const Vector<2> x = part_.lattice().point(site);
      throw UserError(
          fmt::format("-couple_scheme {} needs plain elements within a horizon of each patch, but the ghost "
                      "at {} lies in another patch: move the patches apart or use energy",
                      options_.scheme == Scheme::ghost ? "ghost" : "interface", options_.frame.text(x)));
    });
  }

  /// True if bonds may end at a site outside the patch.
  bool bonded(const Site<2>& site) const
  {
    if (part_.lattice().contains(site)) return false;
    return options_.scheme == Scheme::energy ? exists_(site) : around_.outside(site);
  }

  /// Of the bond along an arm from a site, as of any bond of the patch.
  double surface_factor(const Site<2>& site, std::size_t arm, int sign) const
  {
    if (!factors_.of) return 1.0;
    const Site<2> lower = sign > 0 ? site : stepped(site, part_.stencil().half[arm].step, -1);
    return factors_.any(lower) ? factors_.of(lower, arm) : 1.0;
  }

  /// Lattice cells beside a free side in which corrected bonds meet the interface.
  Index zone() const { return factors_.even_over; }

  /// Bonds of a patch by the site they start from, in the lattice or around it, their arm and its sign.
  std::uint64_t key(const Site<2>& site, std::size_t arm, int sign) const
  {
    const Index reach = part_.stencil().reach;
    const auto width = static_cast<std::uint64_t>(part_.lattice().count[0] + 2 * reach);
    const auto number =
        static_cast<std::uint64_t>(site[1] + reach) * width + static_cast<std::uint64_t>(site[0] + reach);
    return (number * pd::kMaxHalfArms + arm) * 2 + (sign > 0);
  }

  bool mine(const Host& host) const
  {
    for (std::size_t k = 0; k < static_cast<std::size_t>(host.count); ++k)
      if (rows_.owns(host.rows[k])) return true;
    return false;
  }

  /// Bonds from a particle to material outside the patch.
  void leave_from(const Site<2>& site)
  {
    const Index row = part_.row(site);
    const auto& lattice = part_.lattice();
    const Vector<2> x = lattice.point(site);
    const double far = (part_.stencil().reach + 2) * lattice.dx;
    if (row < 0 && options_.scheme == Scheme::energy && (!mine_ || !mine_->contains(x, far))) return;
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h)
      for (const int sign : {+1, -1}) {
        const pd::Arm<2>& arm = part_.stencil().half[h];
        const Site<2> other = stepped(site, arm.step, sign);
        if (!bonded(other)) continue;
        Draft draft;
        draft.key = key(site, h, sign);
        draft.site = static_cast<Index>(lattice.number(site));
        draft.row = row < 0 ? -1 : rows_.first + row;
        draft.kappa = arm.kappa * surface_factor(site, h, sign);
        draft.xi = sign * arm.xi;
        draft.energy_share = arm.length / part_.stencil().volume();
        draft.volume = arm.volume_share * part_.stencil().volume();
        if (!place_far_end(draft, site, other)) continue;
        judge(draft, x, draft.xi, {x, lattice.point(other)});
        if (row >= 0 || mine(draft.b) || mine(draft.force_b)) drafts_.push_back(draft);
      }
  }

  /// The part of the bond between two sites that lies in the patch. In spacings, where sites, sides and steps are
  /// numbers without rounding: a bond through a corner touches it, and is no short spring.
  std::optional<geom::Clip> inner_part(const Site<2>& from, const Site<2>& to) const
  {
    const auto middle = [](const Site<2>& site) { return Vector<2>(site[0] + 0.5, site[1] + 0.5); };
    const auto& count = part_.lattice().count;
    return geom::clip<2>(middle(from), middle(to), {{0.0, 0.0}, {1.0 * count[0], 1.0 * count[1]}});
  }

  /// Chooses what carries the outer end; false where the bond leaves through a side without elements behind.
  bool place_far_end(Draft& draft, const Site<2>& site, const Site<2>& other) const
  {
    std::optional<Host> edge;
    if (options_.scheme != Scheme::ghost) {
      const Vector<2> x = part_.lattice().point(site);
      const auto part = inner_part(site, other);
      edge = around_.edge_host(x + part->leave * draft.xi, -part->leave * draft.xi, zone());
      if (!edge) return false;
      if (options_.scheme == Scheme::energy) draft.xi *= part->leave;
    }
    draft.b = options_.scheme == Scheme::energy ? *edge : around_.element_host(other);
    draft.force_b = options_.scheme == Scheme::ghost ? draft.b : *edge;
    return true;
  }

  /// Bonds between two outside sites whose middle part lies in a corner of the patch.
  void clip_from(const Site<2>& site)
  {
    const auto& lattice = part_.lattice();
    if (!bonded(site)) return;
    const Vector<2> x = lattice.point(site);
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h) {
      const pd::Arm<2>& arm = part_.stencil().half[h];
      const Site<2> other = stepped(site, arm.step, 1);
      if (!bonded(other)) continue;
      const auto part = inner_part(site, other);
      if (!part || part->enter >= part->leave) continue;
      const Vector<2> begin = x + part->enter * arm.xi, half = 0.5 * (part->leave - part->enter) * arm.xi;
      const auto enter = around_.edge_host(begin, half, zone());
      const auto leave = around_.edge_host(x + part->leave * arm.xi, -half, zone());
      if (!enter || !leave) continue;
      Draft draft;
      draft.key = key(site, h, 1);
      draft.kappa = arm.kappa * surface_factor(site, h, 1);
      draft.force_a = *enter;
      draft.force_b = *leave;
      const bool energy = options_.scheme == Scheme::energy;
      draft.a = energy ? *enter : around_.element_host(site);
      draft.b = energy ? *leave : around_.element_host(other);
      draft.xi = energy ? Vector<2>(2.0 * half) : arm.xi;
      judge(draft, energy ? begin : x, draft.xi, {x, lattice.point(other)});
      // Rows of `a` count the energy.
      if (mine(draft.force_a) || mine(draft.force_b) || mine(draft.a)) drafts_.push_back(draft);
    }
  }

  /// Is the part of the bond that acts cut by a crack, and may it break?
  void judge(Draft& draft, const Vector<2>& begin, const Vector<2>& acts, const std::array<Vector<2>, 2>& ends) const
  {
    const bool moved = draft.a.across || draft.b.across || draft.force_a.across || draft.force_b.across;
    // A bond that meets the border where a crack enters moves there with its own side, from whichever side it comes.
    const auto touch = [&acts](const Host& end) { return Vector<2>((end.sided ? kTouch : 0.0) * acts); };
    const Vector<2> from = begin + touch(draft.a), to = begin + acts - touch(draft.b);
    draft.cut = moved;
    for (const crack::CrackSet* cracks : {options_.cracks, options_.seams})
      draft.cut = draft.cut || (cracks && cracks->cuts(from, to));
    for (const geom::Box<2>& box : options_.no_fail)
      for (const Vector<2>& end : ends) draft.no_fail = draft.no_fail || box.contains(end);
  }

  const field::Rows& rows_;
  const CouplingOptions& options_;
  const Part& part_;
  const Surroundings& around_;
  pd::Exists<2> exists_;
  std::optional<geom::Box<2>> mine_;
  pd::BondFactors<2> factors_;
  std::vector<Draft> drafts_;
};

/// Finds the rows of particles of other ranks. Collective.
void complete(std::vector<Draft>& drafts, const Part& part)
{
  std::vector<Index> sites;
  for (const Draft& draft : drafts)
    if (draft.site >= 0 && draft.row < 0) sites.push_back(draft.site);
  const std::vector<PetscInt> rows = part.directory().rows(sites);
  std::size_t next = 0;
  for (Draft& draft : drafts)
    if (draft.site >= 0 && draft.row < 0) draft.row = rows[next++];
}
} // namespace

pd::Exists<2> family_of(const Surroundings& around, const pd::Stencil<2>& stencil, Scheme scheme)
{
  if (scheme == Scheme::energy)
    return [&around](const Site<2>& site) { return around.exists(site) || around.behind_elements(site); };
  if (scheme == Scheme::interface) return [&around](const Site<2>& site) { return around.exists(site); };
  const Index layers = pd::family_reach(stencil);
  return [&around, layers](const Site<2>& site) {
    const auto& count = around.shape().lattice.count;
    return site[0] >= -layers && site[1] >= -layers && site[0] < count[0] + layers && site[1] < count[1] + layers &&
           around.exists(site);
  };
}

std::unique_ptr<CarriedBonds<2>> carry_bonds(const field::Rows& rows, const CouplingOptions& options,
                                             std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                             std::span<const Surroundings> around)
{
  static Event event("couple_bonds");
  Timed timed(event);
  CarriedPoints<2> points;
  std::vector<CarriedBond<2>> bonds;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::vector<Draft> drafts = Drafter(rows, options, *parts[p], around[p]).write();
    complete(drafts, *parts[p]);
    PetscInt last_row = -1;
    Index last_point = -1;
    for (const Draft& draft : drafts) {
      CarriedBond<2> bond;
      bond.xi = draft.xi;
      bond.kappa = draft.kappa;
      bond.energy_share = draft.energy_share;
      bond.volume = draft.volume;
      bond.cut = draft.cut;
      bond.no_fail = draft.no_fail;
      bond.patch = static_cast<int>(p);
      bond.key = static_cast<std::uint64_t>(p) << kPatchBit | draft.key;
      if (draft.site >= 0) {
        if (draft.row != last_row) last_point = points.add(Host::of_row(draft.row));
        last_row = draft.row;
        bond.a = bond.force_a = last_point;
      } else {
        bond.a = points.add(draft.a);
        bond.force_a = options.scheme == Scheme::interface ? points.add(draft.force_a) : bond.a;
      }
      bond.b = points.add(draft.b);
      bond.force_b = options.scheme == Scheme::interface ? points.add(draft.force_b) : bond.b;
      bonds.push_back(bond);
    }
  }
  return std::make_unique<CarriedBonds<2>>(rows, std::move(points), std::move(bonds), options.kinematics,
                                           options.scheme != Scheme::interface);
}

Index count_ghosts(std::span<const Surroundings> around, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts)
{
  Index ghosts = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto& lattice = parts[p]->lattice();
    const Index reach = parts[p]->stencil().reach;
    for (Site<2> site{0, -reach}; site[1] < lattice.count[1] + reach; ++site[1])
      for (site[0] = -reach; site[0] < lattice.count[0] + reach; ++site[0]) {
        if (!around[p].outside(site)) continue;
        bool bonded = false;
        for (const pd::Arm<2>& arm : parts[p]->stencil().half)
          for (const int sign : {+1, -1}) bonded |= lattice.contains(stepped(site, arm.step, sign));
        ghosts += bonded;
      }
  }
  return ghosts;
}
} // namespace pdx::couple
