#include "broken_carried.hpp"
#include "particle_part.hpp"
#include "pdx/adapt/quiet.hpp"
#include "pdx/mesh/sites.hpp"
#include "pdx/scene/layout.hpp"
#include "pdx/scene/scene_warnings.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace pdx::scene {
namespace {
/// What is active on either of two pieces of one lattice, as the first counts its sites.
geom::SiteSet<2> united(const track::TreeGround& ground, const couple::PatchShape& shape)
{
  std::vector<geom::SiteSet<2>::Corners> boxes;
  const auto add = [&boxes](const geom::SiteSet<2>& set, const Site<2>& shift) {
    for (const geom::SiteRun<2>& run : set.runs()) {
      const Site<2> first{run.first[0] + shift[0], run.first[1] + shift[1]};
      boxes.push_back({first, {first[0] + run.length, first[1] + 1}});
    }
  };
  const auto away = [&](std::size_t d) { return static_cast<Index>(shape.names.first[d] - ground.names.first[d]); };
  add(ground.where.active, {0, 0});
  add(shape.active, {away(0), away(1)});
  return geom::SiteSet<2>(boxes);
}

/// Patches of a scene in the plane, and the bonds by which elements carry their ends.
class PatchPart final : public ParticlePart<2> {
public:
  PatchPart(const mesh::Mesh& mesh, const Discretisation& d)
      : ParticlePart<2>(d, *d.bonds, d.carried), mesh_(mesh), d_(d), plan_(*d.patch_plan)
  {}

  void add_names(std::vector<field::RowName>& names) const override
  {
    names.reserve(names.size() + model_.particles.size());
    for (std::size_t p = 0; p < bonds_.parts().size(); ++p)
      scene::add_names(plan_.shapes[p], bonds_.parts()[p]->sites(), names);
  }
  field::RowName row_name(Index row) const override
  {
    if (row < model_.system.rows.first_particle()) return {};
    const pd::Particle& particle =
        model_.particles[static_cast<std::size_t>(row - model_.system.rows.first_particle())];
    return name(static_cast<std::size_t>(particle.patch), particle.site);
  }

  void add_numbers(std::vector<PetscInt>& first) const override
  {
    for (const couple::PatchShape& shape : plan_.shapes)
      first.push_back(first.back() + static_cast<PetscInt>(shape.active.size()));
  }

  std::string described() const override
  {
    std::string text;
    for (std::size_t p = 0; p < plan_.shapes.size(); ++p) {
      const couple::PatchShape& shape = plan_.shapes[p];
      text += fmt::format("patch {} = ", p + 1) + line_of<2>(shape.lattice, plan_.stencils[p].half.size());
      for (const geom::Box<2>& box : shape.boxes)
        if (!shape.active.is_box())
          text += fmt::format("box of patch {} = {} {} {} {}\n", p + 1, box.lower[0], box.lower[1], box.upper[0],
                              box.upper[1]);
    }
    return text;
  }

  std::string warning(const options::SceneOptions& options) const override { return row_warning(options, plan_); }

  bool carries_bonds() const override { return carried_ != nullptr; }
  std::vector<std::uint64_t> broken_carried() const override
  {
    return carried_ ? carried_->broken() : std::vector<std::uint64_t>{};
  }
  void break_bonds(const BrokenBonds& broken) override
  {
    ParticlePart<2>::break_bonds(broken);
    std::vector<BrokenCarried<2, geom::SiteNames>::Lattice> lattices;
    for (std::size_t p = 0; p < plan_.shapes.size(); ++p)
      lattices.push_back({plan_.shapes[p].names, plan_.stencils[p]});
    const BrokenCarried<2, geom::SiteNames> parted(std::move(lattices));
    if (broken.changed && broken.carried) parted.break_joined(bonds_, *broken.carried);
    if (carried_) carried_->set_broken(broken.changed ? parted.keys(*carried_, broken) : *broken.carried);
  }
  void add_torn(BrokenBonds& broken) const override
  {
    for (std::size_t p = 0; p < bonds_.parts().size(); ++p) {
      if (!bonds_.is_kept(p)) continue;
      const pd::LatticePart<2>& part = *bonds_.parts()[p];
      for (const auto& [k, words] : part.torn()) {
        broken.torn.push_back(name(p, part.sites()[static_cast<std::size_t>(k)]));
        broken.torn_words.insert(broken.torn_words.end(), words.begin(), words.end());
      }
    }
  }

  /// The lattices that particles lie on, each once.
  std::vector<track::TreeGround> grounds(const options::SceneOptions& given) const override
  {
    const options::SceneOptions options = Layout::given(given).in(given);
    std::vector<track::TreeGround> grounds;
    for (const couple::PatchShape& shape : patch_shapes(options)) {
      const auto known = std::ranges::find_if(
          grounds, [&](const track::TreeGround& ground) { return ground.names.lattice == shape.names.lattice; });
      if (known == grounds.end())
        grounds.push_back({{shape.lattice, shape.active}, options.pd.horizon_ratio * shape.lattice.dx, shape.names});
      else
        known->where.active = united(*known, shape);
    }
    return grounds;
  }

  Watched watched() const override
  {
    couple::ParticleDamage all = damage();
    for (std::size_t k = 0; k < all.damage.size(); ++k) all.damage[k] += all.precrack[k];
    return {std::move(all.damage), [this](std::size_t k) {
              const pd::Particle& particle = model_.particles[k];
              return name(static_cast<std::size_t>(particle.patch), particle.site).key();
            }};
  }

  std::vector<double> damage_of(std::span<const std::size_t> particles) const override
  {
    std::vector<double> some;
    for (const std::size_t k : particles) {
      const Index row = model_.system.rows.first_particle() + static_cast<Index>(k);
      pd::BondedVolume volume;
      bonds_.parts()[static_cast<std::size_t>(model_.particles[k].patch)]->add_bonded_volume(row, volume);
      if (carried_) carried_->add_bonded_volume(row, volume);
      some.push_back(pd::damage(volume) + pd::precrack_share(volume));
    }
    return some;
  }

  std::vector<SeenParticle> seen() const override
  {
    const couple::ParticleDamage all = damage();
    std::vector<SeenParticle> seen;
    for (std::size_t k = 0; k < model_.particles.size(); ++k) {
      const pd::Particle& particle = model_.particles[k];
      const couple::PatchShape& shape = shape_of(particle);
      const Site<2> site = shape.active.site(particle.site);
      seen.push_back({mesh_.body(particle.cell),
                      shape.names.lattice,
                      {shape.names.first[0] + site[0], shape.names.first[1] + site[1]},
                      all.damage[k],
                      all.precrack[k],
                      particle.x,
                      shape.lattice.dx});
    }
    return seen;
  }

  void count_sites(Index body, std::int64_t lattice, std::size_t axis,
                   std::map<std::int64_t, std::int64_t>& columns) const override
  {
    constexpr Index anywhere = std::numeric_limits<Index>::max() / 4;
    const auto shape = std::ranges::find_if(
        plan_.shapes, [&](const couple::PatchShape& of) { return of.body == body && of.names.lattice == lattice; });
    if (shape == plan_.shapes.end()) return;
    const std::vector<bool> may = adapt::may_be_particles(d_.view(mesh_));
    for (Index c = 0; c < mesh_.owned_cells(); ++c)
      if (mesh_.body(c) == body && may[static_cast<std::size_t>(c)])
        mesh::for_each_site(mesh_, c, shape->lattice, anywhere, [&](const Site<2>& site, const Vector<2>&) {
          ++columns[shape->names.first[axis] + site[axis]];
        });
  }

private:
  const couple::PatchShape& shape_of(const pd::Particle& particle) const
  {
    return plan_.shapes[static_cast<std::size_t>(particle.patch)];
  }

  field::RowName name(std::size_t patch, Index site) const override
  {
    const couple::PatchShape& shape = plan_.shapes[patch];
    return field::RowName::particle(shape.names.of(shape.active.site(site)));
  }

  const mesh::Mesh& mesh_;
  const Discretisation& d_;
  const PatchPlan& plan_;
};
} // namespace

std::unique_ptr<Part> patch_part(const mesh::Mesh& mesh, const Discretisation& d)
{
  return std::make_unique<PatchPart>(mesh, d);
}
} // namespace pdx::scene
