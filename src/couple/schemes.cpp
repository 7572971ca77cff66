#include "pdx/couple/schemes.hpp"

#include "pdx/base/events.hpp"
#include "pdx/geom/line_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pdx::couple {
namespace {
using Part = pd::LatticePart<2>;
constexpr double kTouch = 1e-9;  // of the acting part of a bond, at either end
constexpr double kInside = 1e-6; // likewise, so far from an end is its material

Site<2> stepped(Site<2> site, const Site<2>& step, int sign)
{
  site[0] += sign * step[0];
  site[1] += sign * step[1];
  return site;
}

/// A bond before the rows of particles of other ranks are known. `site` >= 0: the end `a` is that particle.
struct Draft : CarriedBond<2> {
  Index site = -1;
  PetscInt row = -1; // global row of the particle, -1 while unknown
  Index other = -1;  // a particle at the end `b`, and its row
  PetscInt other_row = -1;

  Draft() { a = b = force_a = force_b = -1; } // none of `a` where a particle is
};

/// What carries the ends of a bond, and what the points where its force acts; null where a particle is.
struct Ends {
  const Host *a = nullptr, *b = nullptr, *force_a = nullptr, *force_b = nullptr;
};

/// Writes the drafts of one patch, in order of sites, and the points that elements carry.
class Drafter {
public:
  Drafter(const field::Rows& rows, const CouplingOptions& options, Part& part, const Surroundings& around,
          CarriedPoints<2>& points)
      : rows_(rows), options_(options), part_(part), around_(around), points_(points),
        exists_(family_of(around, part.stencil(), options.scheme)),
        mine_(around.edges_of_rows(rows.first, rows.first + rows.owned()))
  {
    for (const pd::Arm<2>& arm : part.stencil().half)
      lines_.push_back({geom::pieces_of_line<2>({-arm.step[0], -arm.step[1]}), geom::pieces_of_line<2>(arm.step)});
    const Index reach = part.stencil().reach; // bonds that clip a corner start and end outside
    const auto& count = part.lattice().count;
    factors_ = part.take_factors({-reach, -reach}, {count[0] + 2 * reach, count[1] + 2 * reach});
  }

  std::vector<Draft> write()
  {
    refuse_homeless_ghosts();
    for_each_border_site([&](const Site<2>& site) {
      if (part_.active().has(site)) leave_from(site);
    });
    if (!ghosts_) for_each_border_site([&](const Site<2>& site) { clip_from(site); });
    return std::move(drafts_);
  }

private:
  /// Sites whose bonds may meet the border: on either side, in order.
  template <class Visit> void for_each_border_site(Visit&& visit) const
  {
    const Index reach = part_.stencil().reach;
    const geom::SiteSet<2>& active = part_.active();
    const geom::SiteSet<2> deep = active.eroded(reach), near = active.grown(reach);
    for (Site<2> site{0, near.lower()[1]}; site[1] < near.upper()[1]; ++site[1])
      for (site[0] = near.lower()[0]; site[0] < near.upper()[0]; ++site[0]) {
        if (deep.has(site)) site[0] = deep.end_of_run(site); // jump over the inside
        if (near.has(site)) visit(std::as_const(site));
      }
  }

  void refuse_homeless_ghosts() const
  {
    if (options_.scheme == Scheme::energy) return;
    for_each_border_site([&](const Site<2>& site) {
      if (!around_.outside(site) || around_.element_host(site).count) return;
      const Vector<2> x = part_.lattice().point(site);
      throw UserError(
          options_.scheme == Scheme::handshake
              ? fmt::format("{} needs one lattice of particles in a body, but the site at {} lies in a patch of "
                            "another: use energy",
                            option_of(options_.scheme), options_.frame.text(x))
              : fmt::format("{} needs plain elements within a horizon of each patch, but the ghost "
                            "at {} lies in another patch: move the patches apart or use energy",
                            option_of(options_.scheme), options_.frame.text(x)));
    });
  }

  /// True if bonds may end at a site: a particle, or material outside the patch.
  bool bonded(const Site<2>& site) const
  {
    if (part_.active().has(site)) return true;
    return options_.scheme == Scheme::energy ? exists_(site) : around_.outside(site);
  }

  /// Of the bond along an arm from a site, as of any bond of the patch.
  double surface_factor(const Site<2>& site, std::size_t arm, int sign) const
  {
    if (!factors_.of) return 1.0;
    const Site<2> lower = sign > 0 ? site : stepped(site, part_.stencil().half[arm].step, -1);
    if (!factors_.any(lower)) return 1.0;
    return factors_.surface ? factors_.surface(lower, arm) : factors_.of(lower, arm);
  }

  /// Lattice cells beside a free side in which corrected bonds meet the interface.
  Index zone() const { return factors_.even_over; }

  /// Names a bond of the body, by the site it starts from, its arm and the arm's sign, and the part of it that acts:
  /// 0 from its beginning, else the number of the cell on its way that it enters, + 1.
  std::uint64_t key(const Site<2>& site, std::size_t arm, int sign, int part) const
  {
    const std::uint64_t bond = (around_.shape().names.of(site) * pd::kMaxHalfArms + arm) * 2 + (sign > 0);
    return bond * kPartsOfBonds + static_cast<std::uint64_t>(part);
  }

  bool mine(const Host* host) const
  {
    for (std::size_t k = 0; host && k < static_cast<std::size_t>(host->count); ++k)
      if (rows_.owns(host->rows[k])) return true;
    return false;
  }

  /// Forces act where the ends are, but in the interface scheme.
  void keep(Draft& draft, const Ends& ends)
  {
    const bool apart = options_.scheme == Scheme::interface;
    if (ends.a) draft.a = points_.add(*ends.a);
    if (ends.a) draft.force_a = apart ? points_.add(*ends.force_a) : draft.a;
    if (ends.b) draft.b = points_.add(*ends.b);
    if (ends.b) draft.force_b = apart ? points_.add(*ends.force_b) : draft.b;
    drafts_.push_back(draft);
  }

  /// Bonds from a particle that leave the patch, up to where they do.
  void leave_from(const Site<2>& site)
  {
    const Index row = part_.row(site);
    const auto& lattice = part_.lattice();
    const Vector<2> x = lattice.point(site);
    const double far = (part_.stencil().reach + 2) * lattice.dx;
    if (row < 0 && options_.scheme == Scheme::energy && (!mine_ || !mine_->contains(x, far))) return;
    const double handed = handed_per_stiffness(site);
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h)
      for (const int sign : {+1, -1}) {
        const pd::Arm<2>& arm = part_.stencil().half[h];
        const Site<2> other = stepped(site, arm.step, sign);
        const auto& line = lines_[h][sign > 0];
        if (geom::runs_inside<2>(part_.active(), site, line) || !bonded(other)) continue;
        Draft draft;
        draft.key = key(site, h, sign, 0);
        draft.site = part_.number(site);
        draft.row = row < 0 ? -1 : rows_.first + row;
        draft.kappa = arm.kappa * surface_factor(site, h, sign);
        draft.xi = sign * arm.xi;
        draft.from = x;
        draft.energy_share = arm.length / part_.stencil().volume();
        draft.volume = arm.volume_share * part_.stencil().volume();
        const double leave = leaves(site, line);
        const std::optional<Host> edge =
            ghosts_ ? std::nullopt : around_.edge_host(x + leave * draft.xi, -leave * draft.xi, zone());
        if (!ghosts_ && !edge) continue; // leaves through a side without elements behind
        draft.handed = handed * (1.0 - leave) * draft.kappa * arm.length;
        if (options_.scheme == Scheme::energy) draft.xi *= leave;
        Ends ends;
        if (ghosts_ && part_.active().has(other)) { // over what is no particle: half from either end
          const Index other_row = part_.row(other);
          if (row < 0 && other_row < 0) continue;
          draft.other = part_.number(other);
          draft.other_row = other_row < 0 ? -1 : rows_.first + other_row;
          draft.kappa *= 0.5;
          draft.energy_share *= 2.0;
          judge(draft, ends, x, draft.xi, {site, other});
          keep(draft, ends);
          continue;
        }
        ends.b = options_.scheme == Scheme::energy ? &*edge : &around_.element_host(other);
        ends.force_b = ghosts_ ? ends.b : &*edge;
        if (row < 0 && !mine(ends.b) && !mine(ends.force_b)) continue;
        if (edge && edge->side >= 0)
          draft.leaves = around_.leaving(edge->side, site, {sign * leave * arm.step[0], sign * leave * arm.step[1]});
        judge(draft, ends, x, draft.xi, {site, other});
        if (draft.cut) draft.handed = 0.0;
        keep(draft, ends);
      }
  }

  /// Mass of a particle over the sum of stiffness times length of all its bonds; 0 if none is handed over [kg/(N m)].
  double handed_per_stiffness(const Site<2>& site) const
  {
    if (options_.handed_density == 0.0) return 0.0;
    double sum = 0.0;
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h)
      for (const int sign : {+1, -1}) {
        const pd::Arm<2>& arm = part_.stencil().half[h];
        if (bonded(stepped(site, arm.step, sign))) sum += arm.kappa * surface_factor(site, h, sign) * arm.length;
      }
    return sum > 0.0 ? options_.handed_density * part_.stencil().volume() / sum : 0.0;
  }

  /// Where a line that starts at a particle first leaves the patch.
  double leaves(const Site<2>& site, std::span<const geom::LinePiece<2>> line) const
  {
    double leave = 0.0;
    for (const geom::LinePiece<2>& piece : line) {
      if (!part_.active().has(geom::cell_at<2>(site, piece))) break;
      leave = piece.leave;
    }
    return leave;
  }

  /// Bonds with a part in the patch that ends at the border on both sides.
  void clip_from(const Site<2>& site)
  {
    const geom::SiteSet<2>& active = part_.active();
    if ((active.is_box() && active.has(site)) || !bonded(site)) return;
    for (std::size_t h = 0; h < part_.stencil().half.size(); ++h) {
      if (!geom::comes_in<2>(active, site, lines_[h][1])) continue; // that begins in the patch leaves it above
      const Site<2> other = stepped(site, part_.stencil().half[h].step, 1);
      if ((active.is_box() && active.has(other)) || !bonded(other)) continue;
      for (const geom::PartInside& part : geom::parts_inside<2>(active, site, lines_[h][1]))
        if (part.clip.enter > 0.0 && (part.clip.leave < 1.0 || !active.has(other))) clip(site, other, h, part);
    }
  }

  void clip(const Site<2>& site, const Site<2>& other, std::size_t h, const geom::PartInside& part)
  {
    const pd::Arm<2>& arm = part_.stencil().half[h];
    const auto& [enters, leaves] = part.clip;
    const Vector<2> x = part_.lattice().point(site);
    const Vector<2> begin = x + enters * arm.xi, half = 0.5 * (leaves - enters) * arm.xi;
    const auto enter = around_.edge_host(begin, half, zone());
    const auto leave = around_.edge_host(x + leaves * arm.xi, -half, zone());
    if (!enter || !leave) return;
    Draft draft;
    draft.key = key(site, h, 1, part.first + 1);
    draft.kappa = arm.kappa * surface_factor(site, h, 1);
    const bool energy = options_.scheme == Scheme::energy;
    const Ends ends{energy ? &*enter : &around_.element_host(site), energy ? &*leave : &around_.element_host(other),
                    &*enter, &*leave};
    if (!mine(ends.force_a) && !mine(ends.force_b) && !mine(ends.a)) return; // rows of `a` count the energy
    draft.xi = energy ? Vector<2>(2.0 * half) : arm.xi;
    draft.from = energy ? begin : x;
    judge(draft, ends, energy ? begin : x, draft.xi, {site, other});
    keep(draft, ends);
  }

  /// Is the part of the bond that acts cut by a crack, and may it break?
  void judge(Draft& draft, const Ends& ends, const Vector<2>& begin, const Vector<2>& acts,
             const std::array<Site<2>, 2>& sites) const
  {
    for (const Host* host : {ends.a, ends.b, ends.force_a, ends.force_b})
      draft.cut = draft.cut || (host && host->across);
    // A bond that meets the border where a crack enters moves there with its own side, from whichever side it comes.
    const auto touch = [&acts](const Host* end) { return Vector<2>((end && end->sided ? kTouch : 0.0) * acts); };
    const Vector<2> from = begin + touch(ends.a), to = begin + acts - touch(ends.b);
    for (const crack::CrackSet* cracks : {options_.cracks, options_.seams})
      draft.cut = draft.cut || (cracks && cracks->cuts(from, to));
    for (const geom::Box<2>& box : options_.no_fail)
      for (const Site<2>& end : sites) draft.no_fail = draft.no_fail || box.contains(part_.lattice().point(end));
    if (options_.regions) judge_material(draft, begin, acts);
    draft.stretch *= 1.0 + (part_.share(sites[0]) + part_.share(sites[1]));
  }

  /// A bond is made of what its acting part lies in: where a material ends with its patch, either side keeps its own.
  void judge_material(Draft& draft, const Vector<2>& begin, const Vector<2>& acts) const
  {
    const Vector<2> inwards = kInside * acts;
    const std::size_t a = options_.regions->at(begin + inwards), b = options_.regions->at(begin + acts - inwards);
    draft.kappa *= options_.regions->stiffness(a, b);
    draft.stretch = options_.regions->stretch(a, b);
    draft.no_fail = draft.no_fail || std::isinf(draft.stretch);
    if (draft.no_fail) draft.stretch = 1.0;
  }

  const field::Rows& rows_;
  const CouplingOptions& options_;
  const Part& part_;
  const Surroundings& around_;
  CarriedPoints<2>& points_;
  bool ghosts_ =
      options_.scheme == Scheme::ghost || options_.scheme == Scheme::handshake; ///< at whose place forces act
  pd::Exists<2> exists_;
  std::optional<geom::Box<2>> mine_;
  std::vector<std::array<std::vector<geom::LinePiece<2>>, 2>> lines_; // per half arm, backwards and along it
  pd::BondFactors<2> factors_;
  std::vector<Draft> drafts_;
};

/// Finds the rows of particles of other ranks. Collective.
void complete(std::vector<Draft>& drafts, const Part& part)
{
  std::vector<Index> sites;
  for (const Draft& draft : drafts)
    for (const auto& [site, row] : {std::pair{draft.site, draft.row}, std::pair{draft.other, draft.other_row}})
      if (site >= 0 && row < 0) sites.push_back(site);
  const std::vector<PetscInt> rows = part.directory().rows(sites);
  std::size_t next = 0;
  for (Draft& draft : drafts)
    for (const auto& [site, row] : {std::pair{draft.site, &draft.row}, std::pair{draft.other, &draft.other_row}})
      if (site >= 0 && *row < 0) *row = rows[next++];
}
} // namespace

pd::Exists<2> family_of(const Surroundings& around, const pd::Stencil<2>& stencil, Scheme scheme)
{
  if (scheme == Scheme::energy)
    return [&around](const Site<2>& site) { return around.exists(site) || around.behind_elements(site); };
  if (scheme == Scheme::interface || scheme == Scheme::handshake)
    return [&around](const Site<2>& site) { return around.exists(site); };
  const Index layers = pd::family_reach(stencil);
  return [&around, layers](const Site<2>& site) {
    const auto& count = around.shape().lattice.count;
    return site[0] >= -layers && site[1] >= -layers && site[0] < count[0] + layers && site[1] < count[1] + layers &&
           around.exists(site);
  };
}

std::unique_ptr<CarriedBonds<2>> carry_bonds(const field::Rows& rows, const CouplingOptions& options,
                                             std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                                             std::span<const Surroundings> around, KeptFamilies kept)
{
  static Event event("couple_bonds");
  Timed timed(event);
  const bool symmetric = options.scheme != Scheme::interface;
  kept.families.resize(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (kept.families[p]) continue;
    CarriedPoints<2> points;
    std::vector<CarriedBond<2>> bonds;
    std::vector<Draft> drafts = Drafter(rows, options, *parts[p], around[p], points).write();
    complete(drafts, *parts[p]);
    bonds.reserve(drafts.size());
    PetscInt last_row = -1;
    Index last_point = -1;
    for (const Draft& draft : drafts) {
      CarriedBond<2> bond = draft;
      bond.patch = static_cast<int>(p);
      if (draft.site >= 0) {
        if (draft.row != last_row) last_point = points.add(Host::of_row(draft.row));
        last_row = draft.row;
        bond.a = bond.force_a = last_point;
      }
      if (draft.other >= 0) bond.b = bond.force_b = points.add(Host::of_row(draft.other_row));
      bonds.push_back(bond);
    }
    kept.families[p] =
        std::make_unique<CarriedFamily<2>>(rows, std::move(points), std::move(bonds), options.kinematics, symmetric);
  }
  return std::make_unique<CarriedBonds<2>>(rows, std::move(kept.families), std::move(kept.shift), options.kinematics,
                                           symmetric);
}

Index count_ghosts(std::span<const Surroundings> around, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts)
{
  Index ghosts = 0;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const auto& lattice = parts[p]->lattice();
    const geom::SiteSet<2>& active = parts[p]->active();
    const Index reach = parts[p]->stencil().reach;
    for (Site<2> site{0, -reach}; site[1] < lattice.count[1] + reach; ++site[1])
      for (site[0] = -reach; site[0] < lattice.count[0] + reach; ++site[0]) {
        if (!around[p].outside(site)) continue;
        bool bonded = false;
        for (const pd::Arm<2>& arm : parts[p]->stencil().half)
          for (const int sign : {+1, -1}) bonded |= active.has(stepped(site, arm.step, sign));
        ghosts += bonded;
      }
  }
  return ghosts;
}
} // namespace pdx::couple
