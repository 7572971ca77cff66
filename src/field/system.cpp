#include "pdx/field/system.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::field {
void System::bind(const std::vector<PetscInt>& also_needed)
{
  std::vector<PetscInt> needed = also_needed;
  for (const auto& term : terms) term->needed_rows(needed);
  halo = std::make_unique<RowHalo>(rows, std::move(needed));
  for (const auto& term : terms) term->bind(*halo);
  int any = rollers.empty() ? 0 : 1;
  MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, rows.comm);
  rolls = any != 0;
  int ranks = 1;
  MPI_Comm_size(rows.comm, &ranks);
  if (ranks == 1) {
    held.assign(static_cast<std::size_t>(rows.owned() * rows.dim), 0);
    for (const Index component : prescribed.components) held[static_cast<std::size_t>(component)] = 1;
    return;
  }
  std::vector<double> flags(static_cast<std::size_t>(rows.owned() * rows.dim), 0.0), all;
  for (const Index component : prescribed.components) flags[static_cast<std::size_t>(component)] = 1.0;
  halo->fetch(flags, rows.dim, all);
  held.assign(all.begin(), all.end());
}

std::vector<double> System::targets(double to) const
{
  std::vector<double> now(prescribed.values);
  for (double& value : now) value *= to;
  for (const Turning& t : turning) {
    const double angle = to * t.angle, half = std::sin(0.5 * angle);
    now[t.at] = std::sin(angle) * t.across - 2.0 * half * half * t.along;
  }
  return now;
}

void System::go_to(double to) const
{
  for (Support* support : supports) support->go_to_load(to);
  if (!swelling) return;
  swelling->now = swelling->at_load(to);
  for (const auto& term : terms) term->swell(swelling->now);
}

bool System::linear() const
{
  return std::all_of(terms.begin(), terms.end(), [](const auto& term) { return term->constant_jacobian(); });
}

bool System::symmetric() const
{
  return std::all_of(terms.begin(), terms.end(), [](const auto& term) { return term->symmetric(); });
}
} // namespace pdx::field
