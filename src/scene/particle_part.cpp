#include "particle_part.hpp"

#include "output_fields.hpp"
#include "pdx/scene/heat.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace pdx::scene {
namespace {
template <int Dim> std::string family(const pd::Stencil<Dim>& stencil)
{
  return fmt::format("{} bonds within {:.6g} m ({:.4g} spacings of {:.6g} m)", 2 * stencil.half.size(), stencil.horizon,
                     stencil.horizon / stencil.dx, stencil.dx);
}

std::int64_t on_all_ranks(MPI_Comm comm, std::int64_t mine)
{
  MPI_Allreduce(MPI_IN_PLACE, &mine, 1, MPI_INT64_T, MPI_SUM, comm);
  return mine;
}
} // namespace

void push_damage(const options::SceneOptions& options, couple::ParticleDamage damage, field::OutputBlock& block)
{
  for (std::size_t k = 0; options.post.precrack_as_damage && k < damage.damage.size(); ++k)
    damage.damage[k] += damage.precrack[k];
  block.fields.push_back({"damage [-]", field::Rank::scalar, false, false, std::move(damage.damage)});
  block.fields.push_back({"precrack [-]", field::Rank::scalar, false, false, std::move(damage.precrack)});
}

const char* unbroken(const options::SceneOptions& options)
{
  return options.fracture.active() ? "" : "; none breaks (no -material_toughness)";
}

void add_particle_shares(std::span<const pd::Particle> particles, std::vector<double>& cells)
{
  for (const pd::Particle& p : particles) cells[static_cast<std::size_t>(p.cell)] += 1.0;
}

template <int Dim> std::string line_of(const geom::Lattice<Dim>& lattice, std::size_t bonds)
{
  return fmt::format("{} particles {} m apart from ({}), {} bonds\n", fmt::join(lattice.count, " x "), lattice.dx,
                     fmt::join(lattice.origin.data(), lattice.origin.data() + Dim, ", "), bonds);
}
template std::string line_of<2>(const geom::Lattice<2>&, std::size_t);
template std::string line_of<3>(const geom::Lattice<3>&, std::size_t);

template <int Dim> void ParticlePart<Dim>::add_energies(std::span<const double> local, post::Energies& mine) const
{
  mine.bonds += bonds_.energy(local);
  if (carried_) mine.interface += carried_->energy(local);
}

template <int Dim> couple::ParticleDamage ParticlePart<Dim>::damage() const
{
  return couple::particle_damage<Dim>(model_.system.rows, bonds_, carried_);
}

template <int Dim> void ParticlePart<Dim>::add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const
{
  blocks.push_back(block(now));
}

/// 2 held, 1 some bond of a full family is missing or carried, 0 inner.
template <int Dim> double ParticlePart<Dim>::kind_of(std::size_t k) const
{
  const std::size_t row = static_cast<std::size_t>(model_.system.rows.first_particle()) + k;
  for (std::size_t a = 0; a < Dim; ++a)
    if (model_.system.held[Dim * row + a]) return 2.0;
  const pd::Particle& particle = model_.particles[k];
  const pd::LatticePart<Dim>& part = *bonds_.parts()[static_cast<std::size_t>(particle.patch)];
  return part.deep(part.site(particle.site)) ? 0.0 : 1.0;
}

/// Displacement, damage where bonds may be missing, strain energy density (bonds that leave their patch included),
/// kind, rank and patch; where bodies are told apart velocity too.
template <int Dim> field::OutputBlock ParticlePart<Dim>::block(const Picture& now) const
{
  const field::Rows& rows = model_.system.rows;
  field::OutputBlock block;
  block.name = "particles";
  const auto& parts = bonds_.parts();
  std::vector<Index> first(parts.size() + 1, 0); // natural numbers: patch after patch
  for (std::size_t p = 0; p < parts.size(); ++p)
    first[p + 1] = first[p] + static_cast<Index>(parts[p]->active().size());
  int rank = 0;
  MPI_Comm_rank(rows.comm, &rank);
  const auto begin = static_cast<std::size_t>(rows.first_particle());
  std::vector<double> density = bonds_.energy_density(now.local);
  if (carried_) carried_->add_energy_density(now.local, density);
  field::OutputField energy{"strain_energy_density [J/m^3]", field::Rank::scalar, false, false, {}};
  field::OutputField kind{"kind", field::Rank::scalar, false, true, {}},
      owner{"rank", field::Rank::scalar, false, true, {}}, patch{"patch", field::Rank::scalar, false, true, {}},
      region{"region", field::Rank::scalar, false, true, {}};
  for (std::size_t k = 0; k < model_.particles.size(); ++k) {
    const pd::Particle& particle = model_.particles[k];
    const auto p = static_cast<std::size_t>(particle.patch);
    const auto x = padded<Dim>(parts[p]->lattice().point(parts[p]->site(particle.site)).data());
    block.points.insert(block.points.end(), x.begin(), x.end());
    block.natural_point.push_back(first[p] + particle.site);
    energy.values.push_back(density[begin + k]);
    kind.values.push_back(kind_of(k));
    owner.values.push_back(rank);
    patch.values.push_back(particle.patch);
    if (now.options.regions) region.values.push_back(static_cast<double>(now.options.regions->at({x[0], x[1]})));
  }
  block.fields.push_back(displacement_field<Dim>(now.local.subspan(Dim * begin), model_.particles.size()));
  if (model_.breaks() || !model_.cracks.empty()) push_damage(now.options, damage(), block);
  push_temperature(now.options, model_.system, block);
  for (field::OutputField* field : {&energy, &kind, &owner, &patch}) block.fields.push_back(std::move(*field));
  if (now.options.regions) block.fields.push_back(std::move(region));
  if (model_.bodies)
    block.fields.push_back(
        vector_field<Dim>("velocity [m/s]", now.velocity.subspan(Dim * begin), model_.particles.size()));
  return block;
}

template <int Dim> std::string ParticlePart<Dim>::counted(const options::SceneOptions& options) const
{
  const MPI_Comm comm = model_.system.rows.comm;
  const std::int64_t bonds = on_all_ranks(comm, bonds_.bonds());
  const std::int64_t carried = on_all_ranks(comm, carried_ ? carried_->bonds() : 0);
  std::vector<std::string> families;
  for (const auto& part : bonds_.parts()) families.push_back(family(part->stencil()));
  std::ranges::sort(families);
  families.erase(std::unique(families.begin(), families.end()), families.end());
  if (families.empty()) return fmt::format("bonds: none before bulk becomes particles{}", unbroken(options));
  return fmt::format("bonds: {} between particles{}; a full family has {}{}", bonds,
                     carried > 0 ? fmt::format(", {} to elements", carried) : "", fmt::join(families, " or "),
                     unbroken(options));
}

template <int Dim> void ParticlePart<Dim>::add_shares(std::vector<double>& cells) const
{
  add_particle_shares(model_.particles, cells);
}

template <int Dim> std::vector<std::uint64_t> ParticlePart<Dim>::gone() const
{
  std::vector<std::uint64_t> words;
  for (const auto& part : bonds_.parts()) {
    std::vector<std::uint64_t> more = part->gone();
    if (words.empty())
      words = std::move(more);
    else
      words.insert(words.end(), more.begin(), more.end());
  }
  return words;
}

template <int Dim> void ParticlePart<Dim>::break_bonds(const BrokenBonds& broken)
{
  auto next = broken.mine.begin();
  for (std::size_t p = 0; p < bonds_.parts().size(); ++p) {
    if (bonds_.is_kept(p)) continue; // knows
    const auto& part = *bonds_.parts()[p];
    const auto end = next + std::ssize(part.sites()) * broken.width;
    std::vector<field::RowName> others; // the words of other ranks' particles too
    for (const Index site : part.halo_sites()) others.push_back(name(p, site));
    std::vector<std::uint64_t> words(next, end);
    next = end;
    const std::vector<std::uint64_t> more = broken.words_of(others);
    words.insert(words.end(), more.begin(), more.end());
    bonds_.set_gone(p, words);
  }
}

template class ParticlePart<2>;
template class ParticlePart<3>;
} // namespace pdx::scene
