#include "pdx/adapt/quiet.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/geom/box_cover.hpp"

#include "cover_list.hpp"
#include "principal_strains.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace pdx::adapt {
namespace quiet {
constexpr double kCalm = 0.5; // of what makes bulk ask

/// The particles of a cell: the plane that fits their displacements best is what the cell bears.
struct Fit {
  int particles = 0;
  bool whole = true; ///< none has lost a bond
  Vector<2> x = Vector<2>::Zero(), u = Vector<2>::Zero();
  Tensor<2> xx = Tensor<2>::Zero(), ux = Tensor<2>::Zero();

  void add(const Vector<2>& place, const Vector<2>& moved)
  {
    ++particles;
    x += place;
    u += moved;
    xx += place * place.transpose();
    ux += moved * place.transpose();
  }
  /// Displacement gradient; none where all lie on a line [-].
  std::optional<Tensor<2>> gradient() const
  {
    const Tensor<2> spread = xx - x * x.transpose() / particles, rise = ux - u * x.transpose() / particles;
    if (spread.determinant() <= 1e-9 * spread.trace() * spread.trace()) return std::nullopt;
    return rise * spread.inverse();
  }
};

bool is_calm(const Fit& fit, const QuietRule& rule)
{
  const std::optional<Tensor<2>> h = fit.whole ? fit.gradient() : std::nullopt;
  if (!h) return false;
  const auto [large, small] = principal_strains(*h);
  if (rule.limits.stretch && large >= kCalm * *rule.limits.stretch) return false;
  return !rule.limits.stress || rule.elastic.principal_stress(large, small) < kCalm * *rule.limits.stress;
}

/// A cell as other ranks are told of it.
struct Told {
  Index body;
  std::array<double, 4> box; ///< lower and upper corner [m]
};

/// Boxes, found by where they are.
class Boxes {
public:
  explicit Boxes(std::vector<Told> boxes) : boxes_(std::move(boxes))
  {
    for (const Told& told : boxes_)
      for (std::size_t d = 0; d < 2; ++d) side_ = std::max(side_, told.box[2 + d] - told.box[d]);
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      const auto& box = boxes_[k].box;
      in_[place(0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3]))].push_back(k);
    }
  }
  /// Does one of the same body overlap a box that is no larger than they are?
  bool meet(Index body, const geom::Box<2>& box) const
  {
    if (boxes_.empty()) return false;
    const auto [column, row] = place(0.5 * (box.lower[0] + box.upper[0]), 0.5 * (box.lower[1] + box.upper[1]));
    for (std::int64_t i = column - 1; i <= column + 1; ++i)
      for (std::int64_t j = row - 1; j <= row + 1; ++j) {
        const auto here = in_.find({i, j});
        if (here == in_.end()) continue;
        for (const std::size_t k : here->second) {
          const auto& [of, other] = boxes_[k];
          if (of == body && box.upper[0] > other[0] && box.upper[1] > other[1] && box.lower[0] < other[2] &&
              box.lower[1] < other[3])
            return true;
        }
      }
    return false;
  }

private:
  using Place = std::pair<std::int64_t, std::int64_t>;
  Place place(double x, double y) const
  {
    return {static_cast<std::int64_t>(std::floor(x / side_)), static_cast<std::int64_t>(std::floor(y / side_))};
  }
  std::vector<Told> boxes_;
  double side_ = 0.0;
  std::map<Place, std::vector<std::size_t>> in_;
};
} // namespace quiet

std::vector<geom::Box<2>> QuietCells::look(const SceneView& scene, const QuietRule& rule,
                                           std::span<const geom::Box<2>> stay, std::span<const double> local)
{
  const mesh::Mesh& mesh = scene.mesh;
  const couple::ParticleDamage lost = couple::particle_damage(scene.halo.rows(), scene.bonds, scene.carried);
  std::map<Index, quiet::Fit> fits; // by local cell
  const auto first = static_cast<std::size_t>(scene.halo.rows().first_particle());
  for (std::size_t k = 0; k < scene.particles.size(); ++k) {
    const pd::Particle& p = scene.particles[k];
    quiet::Fit& fit = fits[p.cell];
    fit.whole = fit.whole && lost.damage[k] <= kBroken && lost.precrack[k] <= kBroken;
    fit.add(p.x - mesh.centroid(p.cell), {local[2 * (first + k)], local[2 * (first + k) + 1]});
  }
  std::unordered_map<Index, int> now;
  std::vector<quiet::Told> unrest;
  for (const auto& [cell, fit] : fits) {
    const Index number = mesh.natural_cell(cell);
    const auto before = quiet_.find(number);
    const int looks = quiet::is_calm(fit, rule) ? (before == quiet_.end() ? 1 : before->second + 1) : 0;
    now[number] = std::min(looks, rule.looks);
    if (looks >= rule.looks) continue;
    const geom::Box<2> box = box_of(mesh, cell);
    const Vector<2> more = (rule.limits.margin - 0.5) * box.size(); // so that rounding leaves whole cells
    const Vector<2> lower = box.lower - more, upper = box.upper + more;
    unrest.push_back({mesh.body(cell), {lower[0], lower[1], upper[0], upper[1]}});
  }
  quiet_ = std::move(now);
  const quiet::Boxes disturbed(gather_all(mesh.comm(), unrest));
  std::vector<Found> mine;
  for (const auto& [cell, fit] : fits) {
    const geom::Box<2> box = box_of(mesh, cell);
    if (quiet_.at(mesh.natural_cell(cell)) < rule.looks || geom::hold(stay, mesh.centroid(cell)) ||
        disturbed.meet(mesh.body(cell), box))
      continue;
    mine.push_back(found(mesh, cell, box, 0.0));
  }
  std::vector<geom::Box<2>> boxes;
  for (const LayoutChange::Cover& cell : gathered(mesh.comm(), mine)) boxes.push_back(cell.box);
  return boxes;
}

void QuietCells::share(MPI_Comm comm)
{
  std::vector<std::array<Index, 2>> mine;
  for (const auto& [cell, looks] : quiet_) mine.push_back({cell, looks});
  for (const auto& [cell, looks] : gather_all(comm, mine)) take(cell, looks);
}

std::vector<bool> may_be_particles(const SceneView& scene)
{
  const mesh::Mesh& mesh = scene.mesh;
  const HeldCells held(scene, true);
  std::vector<bool> may(static_cast<std::size_t>(mesh.owned_cells()));
  for (Index c = 0; c < mesh.owned_cells(); ++c)
    may[static_cast<std::size_t>(c)] = mesh.use(c) == mesh::Use::covered || (can_cover(scene, c) && !held.has(c));
  return may;
}
} // namespace pdx::adapt
