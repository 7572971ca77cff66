#include "pdx/scene/dormant.hpp"

#include "pdx/base/gather.hpp"
#include "pdx/io/natural_order.hpp"
#include "pdx/scene/named_state.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace pdx::scene {
namespace {
constexpr const char* kDormantParticles = "/dormant_particles"; // their names, ascending
constexpr const char* kDormantWords = "/dormant_gone_bonds";    // of each, a bit for each bond it had
constexpr const char* kDormantCarried = "/dormant_carried_bonds";

/// What is wrong with some names, "" if nothing is.
std::string fault_of_names(std::span<const std::uint64_t> names)
{
  const auto is_particle = [](std::uint64_t name) {
    return field::RowName::from(name).kind() == field::RowName::Kind::particle;
  };
  if (!std::ranges::all_of(names, is_particle)) return "names what is no particle";
  return std::ranges::adjacent_find(names, std::greater_equal<>()) == names.end() ? "" : "is not in order";
}
} // namespace

void Dormant::write(io::Hdf5File& file) const
{
  std::vector<std::uint64_t> mine(particles.size());
  std::ranges::transform(particles, mine.begin(), &field::RowName::value);
  std::vector<std::uint64_t> all = gather_all(file.comm(), mine);
  std::ranges::sort(all);
  std::vector<PetscInt> numbers;
  for (const std::uint64_t name : mine)
    numbers.push_back(static_cast<PetscInt>(std::ranges::lower_bound(all, name) - all.begin()));
  const io::NaturalOrder order(file.comm(), static_cast<PetscInt>(all.size()), numbers);
  const std::vector<std::uint64_t> names = order.to_table(mine, 1), words = order.to_table(gone, kLatticeWords);
  file.dataset(kDormantParticles, std::span<const std::uint64_t>(names), 1);
  file.dataset(kDormantWords, std::span<const std::uint64_t>(words), kLatticeWords);
  int rank = 0;
  MPI_Comm_rank(file.comm(), &rank);
  file.dataset(kDormantCarried, std::span(carried).first(rank == 0 ? carried.size() : 0), 1);
}

Dormant Dormant::read(MPI_Comm comm, const io::SealedReader& file)
{
  const std::int64_t total = file.shape(kDormantParticles)[0];
  file.require(kDormantParticles, total < std::numeric_limits<PetscInt>::max() ? "" : "has too many rows");
  file.require(kDormantWords, file.shape(kDormantWords)[0] == total ? "" : "has other rows than there are names");
  const io::Block block = io::block_of(comm, static_cast<PetscInt>(total));
  const PetscInt before = block.rows > 0 && block.first > 0 ? 1 : 0; // the last of the rank below, for their order
  std::vector<std::uint64_t> names(static_cast<std::size_t>(block.rows + before));
  file.read(kDormantParticles, block.first - before, 1, std::span<std::uint64_t>(names));
  file.require(kDormantParticles, fault_of_names(names));
  Dormant dormant;
  dormant.particles.resize(static_cast<std::size_t>(block.rows));
  std::transform(names.begin() + before, names.end(), dormant.particles.begin(), &field::RowName::from);
  dormant.gone.resize(static_cast<std::size_t>(block.rows) * kLatticeWords);
  file.read(kDormantWords, block.first, kLatticeWords, std::span<std::uint64_t>(dormant.gone));
  dormant.carried.resize(static_cast<std::size_t>(file.shape(kDormantCarried)[0]));
  file.read(kDormantCarried, 0, 1, std::span<std::uint64_t>(dormant.carried));
  file.require(kDormantCarried, std::ranges::is_sorted(dormant.carried) ? "" : "is not in order");
  return dormant;
}

void add_dormant(MPI_Comm comm, NamedState& state, const Dormant& dormant)
{
  if (state.carried || !dormant.carried.empty()) {
    const std::vector<std::uint64_t> known = std::move(state.carried).value_or(std::vector<std::uint64_t>{});
    std::ranges::set_union(known, dormant.carried, std::back_inserter(state.carried.emplace()));
  }
  if (!any_rank(comm, !dormant.particles.empty())) return;
  const field::RowMove back(comm, dormant.particles, state.particles);
  const std::vector<std::uint64_t> broken = back.carry(dormant.gone, kLatticeWords);
  for (std::size_t k = 0; k < broken.size(); ++k) state.gone[k] |= broken[k];
  for (const Index k : back.left_behind()) {
    state.particles.push_back(dormant.particles[static_cast<std::size_t>(k)]);
    const auto words = dormant.gone.begin() + kLatticeWords * std::ptrdiff_t{k};
    state.gone.insert(state.gone.end(), words, words + kLatticeWords);
  }
  if (state.cracks) state.cracks->damage.resize(state.particles.size(), -1.0);
}
} // namespace pdx::scene
