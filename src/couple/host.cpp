#include "pdx/couple/surroundings.hpp"

#include <algorithm>

namespace pdx::couple {
Host Host::of_row(PetscInt row)
{
  Host host;
  (void)host.add(row, 1.0);
  return host;
}

bool Host::add(PetscInt row, double weight)
{
  std::size_t k = 0;
  while (k < static_cast<std::size_t>(count) && rows[k] != row) ++k;
  if (k == rows.size()) return false;
  if (k == static_cast<std::size_t>(count)) {
    rows[k] = row;
    weights[k] = tied[k] = 0.0;
    ++count;
  }
  weights[k] += weight;
  tied[k] += weight;
  return true;
}

bool Host::cross(PetscInt node, PetscInt set, double weight, double factor)
{
  if (!add(set, 0.0)) return false;
  const auto at = [&](PetscInt row) { return static_cast<std::size_t>(std::ranges::find(rows, row) - rows.begin()); };
  weights[at(set)] += weight * factor;
  tied[at(set)] += weight;
  tied[at(node)] -= weight;
  return true;
}

bool Host::mix(const Host& other)
{
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
    weights[k] *= 0.5;
    tied[k] *= 0.5;
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(other.count); ++k) {
    if (!add(other.rows[k], 0.0)) return false;
    const auto at = static_cast<std::size_t>(std::ranges::find(rows, other.rows[k]) - rows.begin());
    weights[at] += 0.5 * other.weights[k];
    tied[at] += 0.5 * other.tied[k];
  }
  sided = sided || other.sided;
  across = across || other.across;
  return true;
}
} // namespace pdx::couple
