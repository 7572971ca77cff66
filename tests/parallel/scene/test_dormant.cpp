#include "pdx/scene/dormant.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/scene/named_state.hpp"
#include "support/ranks.hpp"
#include "support/scratch_directory.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace {
using namespace pdx;
using Words = std::vector<std::uint64_t>;

field::RowName name_of(std::uint64_t site) { return field::RowName::particle(site); }

/// Sites 3, 10, 17, ... dealt out in turn from the last rank on, with words that tell which site they are of.
scene::Dormant dealt_out(std::uint64_t count)
{
  scene::Dormant dormant;
  for (std::uint64_t k = count; k-- > 0;) {
    if (static_cast<int>(k) % test::ranks() != test::ranks() - 1 - test::rank()) continue;
    dormant.particles.push_back(name_of(3 + 7 * k));
    dormant.gone.insert(dormant.gone.end(), {100 + k, 200 + k});
  }
  dormant.carried = {4, 8, 15};
  return dormant;
}

std::filesystem::path written(const std::filesystem::path& directory, const scene::Dormant& dormant)
{
  io::Hdf5File file(PETSC_COMM_WORLD, directory / "dormant.h5", io::Hdf5File::Mode::sealed);
  dormant.write(file);
  file.close();
  return directory / "dormant.h5";
}
} // namespace

TEST(Dormant, IsReadInOrderOfNamesByWhateverRanks)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  for (const std::uint64_t count : {0, 1, 2, 20}) {
    const io::SealedReader file(PETSC_COMM_WORLD, written(scratch.path(), dealt_out(count)));
    const scene::Dormant dormant = scene::Dormant::read(PETSC_COMM_WORLD, file);
    EXPECT_EQ(dormant.carried, (Words{4, 8, 15}));
    Words names;
    for (const field::RowName name : dormant.particles) names.push_back(name.key());
    names = gather_all(PETSC_COMM_WORLD, names);
    const Words gone = gather_all(PETSC_COMM_WORLD, dormant.gone);
    ASSERT_EQ(names.size(), count);
    ASSERT_EQ(gone.size(), 2 * count);
    for (std::uint64_t k = 0; k < count; ++k) {
      EXPECT_EQ(names[k], 3 + 7 * k);
      EXPECT_EQ(gone[2 * k], 100 + k);
      EXPECT_EQ(gone[2 * k + 1], 200 + k);
    }
  }
}

TEST(Dormant, TablesThatDoNotBelongTogetherAreRefused)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto refused = [&](const scene::Dormant& dormant) {
    const io::SealedReader file(PETSC_COMM_WORLD, written(scratch.path(), dormant));
    try {
      (void)scene::Dormant::read(PETSC_COMM_WORLD, file);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  scene::Dormant twice;
  twice.particles = {name_of(5)};
  if (test::ranks() == 1) twice.particles.push_back(name_of(5));
  twice.gone.resize(2 * twice.particles.size(), 1);
  EXPECT_NE(refused(twice).find("/dormant_particles"), std::string::npos);
  scene::Dormant node;
  if (test::rank() == 0) node = {{field::RowName::node(5)}, {1, 1}, {}};
  EXPECT_NE(refused(node).find("/dormant_particles names what is no particle"), std::string::npos) << refused(node);
  scene::Dormant unsorted;
  unsorted.carried = {2, 1};
  EXPECT_NE(refused(unsorted).find("/dormant_carried_bonds is not in order"), std::string::npos);
}

TEST(Dormant, ComesBackWhereverItsParticlesCome)
{
  const scene::Dormant dormant = dealt_out(20);
  scene::NamedState state; // this rank has a particle that was there, and one that comes anew
  state.words_per_particle = scene::kLatticeWords;
  const auto mine = static_cast<std::uint64_t>(test::rank());
  state.particles = {name_of(1000 + mine), name_of(3 + 7 * mine)};
  state.gone = {9, 9, 0, 0};
  state.cracks.emplace();
  state.cracks->damage = {0.5, -1.0};
  scene::add_dormant(PETSC_COMM_WORLD, state, dormant);
  EXPECT_EQ(*state.carried, (Words{4, 8, 15}));
  EXPECT_EQ(Words(state.gone.begin(), state.gone.begin() + 4), (Words{9, 9, 100 + mine, 200 + mine}));
  EXPECT_EQ(state.gone.size(), 2 * state.particles.size());
  ASSERT_EQ(state.cracks->damage.size(), state.particles.size());
  EXPECT_TRUE(
      std::all_of(state.cracks->damage.begin() + 1, state.cracks->damage.end(), [](double d) { return d < 0; }));
  Words names;
  for (const field::RowName name : state.particles) names.push_back(name.value());
  names = gather_all(PETSC_COMM_WORLD, names);
  EXPECT_EQ(names.size(), 20 + static_cast<std::size_t>(test::ranks())) << "each once";
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}
