#include "pdx/couple/fracture.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>

namespace pdx::couple {
namespace {
constexpr double kTie = 1e-6; // stretches this near to each other break together

/// The `count` largest values of all ranks, in descending order. Collective.
std::vector<double> largest(MPI_Comm comm, std::vector<double> mine, std::int64_t count)
{
  const auto kept = std::min(static_cast<std::int64_t>(mine.size()), count);
  std::partial_sort(mine.begin(), mine.begin() + kept, mine.end(), std::greater<>());
  mine.resize(static_cast<std::size_t>(kept));
  std::vector<double> all = gather_all(comm, mine);
  std::sort(all.begin(), all.end(), std::greater<>());
  all.resize(std::min(all.size(), static_cast<std::size_t>(count)));
  return all;
}
} // namespace

Fracture::Fracture(pd::BondTerm<2>& bonds, CarriedBonds<2>* carried, FractureRule options)
    : bonds_(bonds), carried_(carried), options_(std::move(options)), comm_(bonds.parts().front()->comm())
{
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (options_.critical_stretch.size() != bonds.parts().size())
    throw UserError(fmt::format("{} critical stretches for {} patches; one per patch is needed",
                                options_.critical_stretch.size(), bonds.parts().size()));
  for (const double stretch : options_.critical_stretch)
    if (!positive(stretch)) throw UserError(fmt::format("critical stretch is {}: must be positive", stretch));
  if (!positive(options_.release_share) || options_.release_share > 1.0)
    throw UserError(fmt::format("release share is {}: must be above 0 and at most 1", options_.release_share));
  bonds_.protect(options_.no_fail);
  Fracture::save();
}

std::vector<pd::BreakRule> Fracture::rules(double scale) const
{
  std::vector<pd::BreakRule> list;
  for (const double stretch : options_.critical_stretch)
    list.push_back({options_.kinematics, scale * stretch, nullptr});
  return list;
}

/// What s0 is to be multiplied with so that only the worst bonds break, at least 1; none where no bond is
/// overstretched. Collective.
std::optional<double> Fracture::worst_scale(const pd::BondTerm<2>::Windows& loaded, std::span<const double> u) const
{
  std::vector<double> ratios;
  bonds_.overstretched(loaded, rules(1.0), ratios);
  if (carried_) carried_->overstretched(u, rules(1.0), ratios);
  auto total = static_cast<std::int64_t>(ratios.size());
  MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPI_INT64_T, MPI_SUM, comm_);
  if (!total) return std::nullopt;
  const auto share = static_cast<std::int64_t>(options_.release_share * static_cast<double>(total));
  const double least = largest(comm_, std::move(ratios), std::max<std::int64_t>(share, 1)).back();
  return std::max(1.0, least * (1.0 - kTie));
}

std::int64_t Fracture::apply(std::span<const double> u)
{
  static Event event("pd_break");
  Timed timed(event);
  const auto& loaded = bonds_.load(u);
  const std::optional<double> scale = options_.release == Release::worst ? worst_scale(loaded, u) : 1.0;
  if (!scale) return 0;
  const std::vector<pd::BreakRule> rule = rules(*scale);
  pd::Broken broken = bonds_.break_bonds(loaded, rule);
  if (carried_) broken += carried_->break_bonds(u, rule);
  MPI_Allreduce(MPI_IN_PLACE, &broken.bonds, 1, MPI_INT64_T, MPI_SUM, comm_);
  MPI_Allreduce(MPI_IN_PLACE, &broken.energy, 1, MPI_DOUBLE, MPI_SUM, comm_);
  now_ += broken;
  return broken.bonds;
}

void Fracture::save()
{
  bonds_.save();
  if (carried_) carried_->save();
  saved_ = now_;
}

void Fracture::restore()
{
  bonds_.restore();
  if (carried_) carried_->restore();
  now_ = saved_;
}

template <int Dim>
ParticleDamage particle_damage(const field::Rows& rows, const pd::BondTerm<Dim>& bonds,
                               const std::type_identity_t<CarriedBonds<Dim>>* carried)
{
  std::vector<pd::BondedVolume> volumes(static_cast<std::size_t>(rows.owned()));
  bonds.add_bonded_volume(volumes);
  if (carried) carried->add_bonded_volume(volumes);
  ParticleDamage result;
  result.damage.reserve(static_cast<std::size_t>(rows.particles));
  result.precrack.reserve(static_cast<std::size_t>(rows.particles));
  for (Index row = rows.first_particle(); row < rows.owned(); ++row) {
    result.damage.push_back(pd::damage(volumes[static_cast<std::size_t>(row)]));
    result.precrack.push_back(pd::precrack_share(volumes[static_cast<std::size_t>(row)]));
  }
  return result;
}

std::vector<Damaged> damaged_particles(const field::Rows& rows, const pd::BondTerm<2>& bonds,
                                       const CarriedBonds<2>* carried)
{
  std::vector<Index> thinned;
  for (const auto& part : bonds.parts()) part->add_thinned(thinned);
  if (carried) carried->add_thinned(thinned);
  std::ranges::sort(thinned);
  thinned.erase(std::unique(thinned.begin(), thinned.end()), thinned.end());
  std::vector<Damaged> found;
  for (const Index row : thinned) {
    pd::BondedVolume volume;
    for (const auto& part : bonds.parts()) part->add_bonded_volume(row, volume);
    if (carried) carried->add_bonded_volume(row, volume);
    if (const double damage = pd::damage(volume); damage > 0.0) found.push_back({row - rows.first_particle(), damage});
  }
  return found;
}

template ParticleDamage particle_damage<2>(const field::Rows&, const pd::BondTerm<2>&, const CarriedBonds<2>*);
template ParticleDamage particle_damage<3>(const field::Rows&, const pd::BondTerm<3>&, const CarriedBonds<3>*);
} // namespace pdx::couple
