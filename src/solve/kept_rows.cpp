#include "pdx/solve/condensed_system.hpp"

#include <algorithm>

namespace pdx::solve {
KeptRows::KeptRows(const field::System& whole, std::span<const Index> kept)
    : whole_(whole), owned_(kept.begin(), kept.end())
{
  const field::Rows& all = whole.rows;
  const auto nodes = static_cast<Index>(std::ranges::lower_bound(owned_, all.nodes) - owned_.begin());
  const Index sets = static_cast<Index>(owned_.size()) - nodes;
  for (Index row = all.first_particle(); row < all.owned(); ++row) owned_.push_back(row);
  rows_ = field::Rows::number(all.comm, all.dim, nodes, sets, all.particles);
  std::vector<double> numbers(static_cast<std::size_t>(all.owned()), -1.0), everywhere;
  for (std::size_t k = 0; k < owned_.size(); ++k)
    numbers[static_cast<std::size_t>(owned_[k])] = static_cast<double>(rows_.first) + static_cast<double>(k);
  whole.halo->fetch(numbers, 1, everywhere);
  renumbered_.assign(everywhere.begin(), everywhere.end());
}

std::vector<PetscInt> KeptRows::needed() const
{
  std::vector<PetscInt> rows;
  std::copy_if(renumbered_.begin() + whole_.rows.owned(), renumbered_.end(), std::back_inserter(rows),
               [](PetscInt row) { return row >= 0; });
  return rows;
}

void KeptRows::bind(const field::RowHalo& halo)
{
  halo_.assign(static_cast<std::size_t>(halo.size() - rows_.owned()), 0);
  for (Index whole = whole_.rows.owned(); whole < whole_.halo->size(); ++whole)
    if (const PetscInt row = renumbered_[static_cast<std::size_t>(whole)]; row >= 0)
      halo_[static_cast<std::size_t>(halo.local(row) - rows_.owned())] = whole;
  local_.assign(static_cast<std::size_t>(whole_.halo->size() * rows_.dim), 0.0);
}

Index KeptRows::kept_row(Index whole) const
{
  const PetscInt row = renumbered_[static_cast<std::size_t>(whole)];
  return row < 0 ? -1 : static_cast<Index>(row - rows_.first);
}

/// Particles stand together in both.
void KeptRows::narrow(std::span<const double> whole, std::span<double> owned) const
{
  const auto dim = static_cast<std::size_t>(rows_.dim);
  const auto few = static_cast<std::size_t>(rows_.first_particle());
  for (std::size_t k = 0; k < few; ++k)
    std::copy_n(whole.data() + static_cast<std::size_t>(owned_[k]) * dim, dim, owned.data() + k * dim);
  std::copy_n(whole.data() + static_cast<std::size_t>(whole_.rows.first_particle()) * dim,
              static_cast<std::size_t>(rows_.particles) * dim, owned.data() + few * dim);
}

void KeptRows::widen(std::span<const double> owned, std::span<double> whole) const
{
  const auto dim = static_cast<std::size_t>(rows_.dim);
  const auto few = static_cast<std::size_t>(rows_.first_particle());
  for (std::size_t k = 0; k < few; ++k)
    std::copy_n(owned.data() + k * dim, dim, whole.data() + static_cast<std::size_t>(owned_[k]) * dim);
  std::copy_n(owned.data() + few * dim, static_cast<std::size_t>(rows_.particles) * dim,
              whole.data() + static_cast<std::size_t>(whole_.rows.first_particle()) * dim);
}

std::span<const double> KeptRows::widened(std::span<const double> local) const
{
  const auto dim = static_cast<std::size_t>(rows_.dim);
  widen(local, local_);
  const double* halo = local.data() + static_cast<std::size_t>(rows_.owned()) * dim;
  for (std::size_t k = 0; k < halo_.size(); ++k)
    std::copy_n(halo + k * dim, dim, local_.data() + static_cast<std::size_t>(halo_[k]) * dim);
  return local_;
}
} // namespace pdx::solve
