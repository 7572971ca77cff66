#include "pdx/change/patch_mover.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::change {
namespace {
constexpr const char* kSeenParticles = "/seen_particles"; // names of sites, ascending
constexpr const char* kSeenDamage = "/seen_damage";       // of each, when patches were looked at last [-]
constexpr const char* kQuietCells = "/quiet_cells";       // natural numbers, ascending
constexpr const char* kQuietLooks = "/quiet_looks";       // of each, in a row
constexpr const char* kExpansions = "/expansions";        // since the last contraction
struct Record {
  std::uint64_t name;
  double damage;
};
} // namespace

void PatchMover::write(io::Hdf5File& file) const
{
  std::vector<Record> mine;
  for (const auto& [name, damage] : seen_.entries()) mine.push_back({name, damage});
  std::vector<Record> all = gather_all(file.comm(), mine);
  std::ranges::sort(all, [](const Record& a, const Record& b) {
    return a.name != b.name ? a.name < b.name : a.damage > b.damage; // what others know of a particle is no more
  });
  const auto again = std::ranges::unique(all, {}, &Record::name);
  all.erase(again.begin(), again.end());
  std::vector<std::uint64_t> names;
  std::vector<double> damage, expansions;
  int rank = 0;
  MPI_Comm_rank(file.comm(), &rank);
  if (rank == 0) expansions.push_back(expansions_);
  for (std::size_t k = 0; k < all.size() && rank == 0; ++k) {
    names.push_back(all[k].name);
    damage.push_back(all[k].damage);
  }
  file.dataset(kSeenParticles, std::span<const std::uint64_t>(names), 1);
  file.dataset(kSeenDamage, std::span<const double>(damage), 1);
  file.dataset(kExpansions, std::span<const double>(expansions), 1);
  if (options_.layout.hand_back == 0) return;
  std::vector<std::array<Index, 2>> quiet;
  for (const auto& [cell, looks] : quiet_.entries()) quiet.push_back({cell, looks});
  quiet = gather_all(file.comm(), quiet);
  std::ranges::sort(quiet);
  const auto twice = std::ranges::unique(quiet);
  quiet.erase(twice.begin(), twice.end());
  std::vector<double> cells, looks;
  for (std::size_t k = 0; k < quiet.size() && rank == 0; ++k) {
    cells.push_back(quiet[k][0]);
    looks.push_back(quiet[k][1]);
  }
  file.dataset(kQuietCells, std::span<const double>(cells), 1);
  file.dataset(kQuietLooks, std::span<const double>(looks), 1);
}

void PatchMover::read(const io::SealedReader& file)
{
  std::vector<std::uint64_t> names(static_cast<std::size_t>(file.shape(kSeenParticles)[0]));
  file.read(kSeenParticles, 0, 1, std::span<std::uint64_t>(names));
  const std::vector<double> damage = file.column(kSeenDamage), expansions = file.column(kExpansions);
  file.require(kSeenParticles, std::ranges::is_sorted(names) ? "" : "is not in order");
  file.require(kSeenDamage, damage.size() == names.size() ? "" : "has other rows than there are names");
  const bool shares = std::ranges::all_of(damage, [](double d) { return d >= 0.0 && d < 1.0 + 1e-6; });
  file.require(kSeenDamage, shares ? "" : "has a number that is no share of bonds");
  const bool counts = expansions.size() == 1 && expansions[0] >= 0.0 && expansions[0] == std::floor(expansions[0]);
  file.require(kExpansions, counts && expansions[0] < 1e9 ? "" : "must hold one whole number from 0 on");
  for (std::size_t k = 0; k < names.size(); ++k) seen_.take(names[k], damage[k]);
  expansions_ = static_cast<int>(expansions[0]);
  if (options_.layout.hand_back == 0) return;
  const std::vector<double> cells = file.column(kQuietCells), looks = file.column(kQuietLooks);
  file.require(kQuietLooks, cells.size() == looks.size() ? "" : "has other rows than there are cells");
  const auto whole = [](double d) { return d >= 0.0 && d < 2e9 && d == std::floor(d); };
  file.require(kQuietCells, std::ranges::all_of(cells, whole) ? "" : "has a number that is no cell's");
  file.require(kQuietLooks, std::ranges::all_of(looks, whole) ? "" : "has a number that counts nothing");
  for (std::size_t k = 0; k < cells.size(); ++k) quiet_.take(static_cast<Index>(cells[k]), static_cast<int>(looks[k]));
}
} // namespace pdx::change
