#include "pdx/couple/support_parts.hpp"

#include "pdx/base/joined.hpp"

#include <algorithm>
#include <bit>

namespace pdx::couple {
namespace {
constexpr double kLeastPart = 0.05; // of the weight around a vertex

bool has_bit(const std::array<std::uint64_t, 2>& words, std::size_t arm) { return words[arm / 64] >> arm % 64 & 1u; }

Site<2> moved(Site<2> site, const Site<2>& step, Index times)
{
  site[0] += times * step[0];
  site[1] += times * step[1];
  return site;
}
} // namespace

SupportParts::SupportParts(const field::Rows& rows, std::span<const std::unique_ptr<pd::LatticePart<2>>> parts,
                           std::vector<CellParticle> particles, Index cells)
    : parts_(parts), particles_(std::move(particles)), offsets_(static_cast<std::size_t>(cells) + 1, 0),
      patches_(parts.size()), damaged_(static_cast<std::size_t>(cells), 0)
{
  std::vector<std::vector<Index>> sites(parts.size());
  for (const CellParticle& particle : particles_) {
    ++offsets_[static_cast<std::size_t>(particle.cell) + 1];
    sites[static_cast<std::size_t>(particle.patch)].push_back(particle.site);
  }
  for (std::size_t c = 0; c + 1 < offsets_.size(); ++c) offsets_[c + 1] += offsets_[c];
  std::vector<std::vector<PetscInt>> found;
  for (std::size_t p = 0; p < parts.size(); ++p) found.push_back(parts[p]->directory().rows(sites[p]));
  std::vector<std::size_t> at(parts.size(), 0);
  std::vector<PetscInt> global;
  for (const CellParticle& particle : particles_) {
    const auto p = static_cast<std::size_t>(particle.patch);
    global.push_back(found[p][at[p]++]);
  }
  std::vector<PetscInt> needed = global; // and the other ends of our particles' bonds, which are told what they lost
  for (std::size_t p = 0; p < parts.size(); ++p) {
    patches_[p].foreign.emplace(*parts[p]);
    needed.insert(needed.end(), patches_[p].foreign->rows().begin(), patches_[p].foreign->rows().end());
  }
  halo_ = std::make_unique<field::RowHalo>(rows, needed);
  for (const PetscInt row : global) rows_.push_back(halo_->local(row));
  place_.assign(particles_.size(), -1);

  for (std::size_t p = 0; p < parts.size(); ++p) {
    Patch& patch = patches_[p];
    if (sites[p].empty()) continue;
    Site<2> upper = patch.lower = parts[p]->site(sites[p].front());
    for (const Index number : sites[p])
      for (std::size_t d = 0; d < 2; ++d) {
        patch.lower[d] = std::min(patch.lower[d], parts[p]->site(number)[d]);
        upper[d] = std::max(upper[d], parts[p]->site(number)[d]);
      }
    for (std::size_t d = 0; d < 2; ++d) patch.extent[d] = upper[d] - patch.lower[d] + 1;
    patch.number.assign(static_cast<std::size_t>(patch.extent[0]) * static_cast<std::size_t>(patch.extent[1]), 0);
  }
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    Patch& patch = patches_[static_cast<std::size_t>(particles_[k].patch)];
    const Site<2> site = parts[static_cast<std::size_t>(particles_[k].patch)]->site(particles_[k].site);
    patch.number[static_cast<std::size_t>((site[1] - patch.lower[1]) * patch.extent[0] + site[0] - patch.lower[0])] =
        static_cast<Index>(k) + 1;
  }
}

std::pair<std::size_t, std::size_t> SupportParts::in_cell(Index cell) const
{
  return {offsets_[static_cast<std::size_t>(cell)], offsets_[static_cast<std::size_t>(cell) + 1]};
}

Index SupportParts::find(int number, const Site<2>& site) const
{
  const Patch& patch = patches_[static_cast<std::size_t>(number)];
  for (std::size_t d = 0; d < 2; ++d)
    if (site[d] < patch.lower[d] || site[d] >= patch.lower[d] + patch.extent[d]) return -1;
  return patch.number[static_cast<std::size_t>((site[1] - patch.lower[1]) * patch.extent[0] + site[0] -
                                               patch.lower[0])] -
         1;
}

void SupportParts::update()
{
  const field::Rows& rows = halo_->rows();
  std::vector<double> owned(2 * static_cast<std::size_t>(rows.owned()), 0.0), all; // bit patterns that travel
  for (const auto& part : parts_)
    for (Index k = 0; k < static_cast<Index>(part->sites().size()); ++k) {
      const auto words = part->words_of(k);
      const auto at = 2 * static_cast<std::size_t>(part->first_row() + k);
      for (std::size_t plane = 0; plane < 2; ++plane) owned[at + plane] = std::bit_cast<double>(words[plane]);
    }
  halo_->fetch(owned, 2, all);
  words_.resize(particles_.size());
  for (std::size_t k = 0; k < particles_.size(); ++k)
    for (std::size_t plane = 0; plane < 2; ++plane)
      words_[k][plane] = std::bit_cast<std::uint64_t>(all[2 * static_cast<std::size_t>(rows_[k]) + plane]);

  const std::vector<double> lost = lost_bonds();
  std::fill(damaged_.begin(), damaged_.end(), std::uint8_t{0});
  health_.assign(particles_.size(), 1.0);
  for (std::size_t k = 0; k < particles_.size(); ++k) {
    const double count = lost[static_cast<std::size_t>(rows_[k])];
    if (count == 0.0) continue;
    const auto& half = parts_[static_cast<std::size_t>(particles_[k].patch)]->stencil().half;
    health_[k] = 1.0 - count / static_cast<double>(2 * half.size());
    damaged_[static_cast<std::size_t>(particles_[k].cell)] = 1;
  }
}

/// Of each local row: bonds of the lattice that its particle lost, alike on every rank that asks. Collective.
std::vector<double> SupportParts::lost_bonds() const
{
  const field::Rows& rows = halo_->rows();
  std::vector<double> lost(static_cast<std::size_t>(halo_->size()), 0.0);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto& part = parts_[p];
    const Patch& patch = patches_[p];
    const auto& half = part->stencil().half;
    for (Index k = 0; k < static_cast<Index>(part->sites().size()); ++k) {
      const auto words = part->words_of(k);
      if (std::popcount(words[0]) + std::popcount(words[1]) == static_cast<int>(half.size())) continue;
      const Site<2> site = part->site(part->sites()[static_cast<std::size_t>(k)]);
      for (std::size_t h = 0; h < half.size(); ++h) {
        if (has_bit(words, h) || !part->begins(site, h)) continue;
        lost[static_cast<std::size_t>(part->first_row() + k)] += 1.0;
        const Site<2> end = moved(site, half[h].step, 1);
        Index other = part->row(end);
        if (other < 0 || other >= rows.owned()) other = halo_->local(patch.foreign->row(part->number(end)));
        lost[static_cast<std::size_t>(other)] += 1.0;
      }
    }
  }
  halo_->reduce(lost, 1);
  std::vector<double> everywhere;
  halo_->fetch(std::span<const double>(lost).first(static_cast<std::size_t>(rows.owned())), 1, everywhere);
  return everywhere;
}

std::vector<PartOfNode> SupportParts::split(std::span<const Index> cells,
                                            const std::function<double(const CellParticle&)>& weight) const
{
  std::vector<PartOfNode> here;
  for (const Index c : cells)
    for (auto [k, end] = in_cell(c); k < end; ++k) {
      place_[k] = static_cast<Index>(here.size());
      here.push_back({k, PartOfNode::kNone});
    }
  Joined joined(here.size());
  for (std::size_t n = 0; n < here.size(); ++n) {
    const CellParticle& particle = particles_[here[n].particle];
    const auto& part = *parts_[static_cast<std::size_t>(particle.patch)];
    const Site<2> site = part.site(particle.site);
    for (std::size_t h = 0; h < part.stencil().half.size(); ++h) {
      if (!has_bit(words_[here[n].particle], h)) continue;
      const Index other = find(particle.patch, moved(site, part.stencil().half[h].step, 1));
      if (other >= 0 && place_[static_cast<std::size_t>(other)] >= 0)
        joined.join(n, static_cast<std::size_t>(place_[static_cast<std::size_t>(other)]));
    }
  }
  for (const PartOfNode& p : here) place_[p.particle] = -1;

  std::vector<double> weights(here.size(), 0.0); // by root
  double total = 0.0;
  for (std::size_t n = 0; n < here.size(); ++n) {
    const double w = weight(particles_[here[n].particle]);
    weights[joined.root(n)] += w;
    total += w;
  }
  int count = 0;
  for (std::size_t n = 0; n < here.size(); ++n) // a root comes before all others of its part
    here[n].part = joined.root(n) != n                ? here[joined.root(n)].part
                   : weights[n] >= kLeastPart * total ? count++
                                                      : PartOfNode::kNone;
  return here;
}
} // namespace pdx::couple
