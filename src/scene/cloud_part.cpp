#include "output_fields.hpp"
#include "particle_part.hpp"
#include "pdx/scene/cloud_body.hpp"

#include <fmt/format.h>

namespace pdx::scene {
template <int Dim> void CloudPart<Dim>::add_names(std::vector<field::RowName>& names) const
{
  for (const pd::Particle& particle : model_.particles)
    names.push_back(field::RowName::particle(static_cast<std::uint64_t>(particle.site)));
}

template <int Dim> void CloudPart<Dim>::add_numbers(std::vector<PetscInt>& first) const
{
  first.push_back(first.back() + model_.system.rows.total);
}

template <int Dim> void CloudPart<Dim>::add_energies(std::span<const double> local, post::Energies& mine) const
{
  mine.bonds += bonds_.energy(local);
}

/// Displacement, velocity, damage where bonds may be missing, volume, set and rank.
template <int Dim> void CloudPart<Dim>::add_blocks(const Picture& now, std::vector<field::OutputBlock>& blocks) const
{
  const std::size_t count = model_.particles.size();
  field::OutputBlock block;
  block.name = "particles";
  for (std::size_t k = 0; k < count; ++k) {
    const std::array<double, 3> x = padded<Dim>(&model_.system.coordinates[Dim * k]);
    block.points.insert(block.points.end(), x.begin(), x.end());
    block.natural_point.push_back(model_.particles[k].site);
  }
  block.fields.push_back(displacement_field<Dim>(now.local, count));
  block.fields.push_back(vector_field<Dim>("velocity [m/s]", now.velocity, count));
  if (model_.breaks() || !model_.cracks.empty()) {
    couple::ParticleDamage damage;
    for (const pd::BondedVolume& volume : bonds_.bonded_volume()) {
      damage.damage.push_back(pd::damage(volume));
      damage.precrack.push_back(pd::precrack_share(volume));
    }
    push_damage(now.options, std::move(damage), block);
  }
  int rank = 0;
  MPI_Comm_rank(model_.system.rows.comm, &rank);
  block.fields.push_back(
      {"volume [m^3]", field::Rank::scalar, false, false, {bonds_.volumes().begin(), bonds_.volumes().end()}});
  block.fields.push_back({"set", field::Rank::scalar, false, true, {sets_.begin(), sets_.end()}});
  block.fields.push_back(
      {"rank", field::Rank::scalar, false, true, std::vector<double>(count, static_cast<double>(rank))});
  blocks.push_back(std::move(block));
}

template <int Dim> std::string CloudPart<Dim>::counted(const options::SceneOptions& options) const
{
  std::int64_t sums[] = {bonds_.part().bonds(), std::ssize(model_.particles)}; // each bond stands in two lists
  MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPI_INT64_T, MPI_SUM, model_.system.rows.comm);
  return fmt::format("bonds: {} between particles within {:.6g} m, {:.1f} for each in the mean{}", sums[0] / 2,
                     options.pd.horizon, static_cast<double>(sums[0]) / static_cast<double>(sums[1]),
                     unbroken(options));
}

template <int Dim> void CloudPart<Dim>::add_shares(std::vector<double>& cells) const
{
  add_particle_shares(model_.particles, cells);
}

template class CloudPart<2>;
template class CloudPart<3>;
} // namespace pdx::scene
