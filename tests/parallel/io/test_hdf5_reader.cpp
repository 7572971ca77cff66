#include "pdx/io/hdf5_reader.hpp"

#include "pdx/base/error.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/natural_order.hpp"
#include "support/scratch_directory.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <petscsys.h>

namespace {
using namespace pdx;
constexpr PetscInt kRows = 7; // of the table; row 3 is nobody's

struct World {
  int rank = 0, size = 1;
  World()
  {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    MPI_Comm_size(PETSC_COMM_WORLD, &size);
  }
  /// Dealt out from behind, so that no rank holds what stands in its block of the table.
  std::vector<PetscInt> held() const
  {
    std::vector<PetscInt> numbers;
    for (PetscInt k = kRows - 1; k >= 0; --k)
      if (k != 3 && k % size == rank) numbers.push_back(k);
    return numbers;
  }
};
} // namespace

TEST(Hdf5Reader, ReadsBackWhatRanksWroteInNaturalOrder)
{
  const World world;
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const std::vector<PetscInt> held = world.held();
  const io::NaturalOrder order(PETSC_COMM_WORLD, kRows, held);
  std::vector<double> values;
  std::vector<std::uint64_t> words;
  for (const PetscInt k : held) {
    values.insert(values.end(), {k + 0.25, -k / 3.0});
    words.push_back(~std::uint64_t{0} - static_cast<std::uint64_t>(k)); // not a number if taken for a double
  }
  const std::filesystem::path path = scratch.path() / "table.h5";
  {
    io::Hdf5File file(PETSC_COMM_WORLD, path.string() + ".part");
    file.attribute("/", "scene", "seven");
    file.dataset("/values", std::span<const double>(order.to_table(values, 2)), 2);
    file.dataset("/words", std::span<const std::uint64_t>(order.to_table(words, 1)), 1);
    file.close();
  }
  io::rename_durably(PETSC_COMM_WORLD, path.string() + ".part", path);
  const io::Hdf5Reader file(PETSC_COMM_WORLD, path);
  EXPECT_EQ(file.text("/", "scene"), "seven");
  EXPECT_EQ(file.shape("/values"), (std::array<std::int64_t, 2>{kRows, 2}));
  std::vector<double> all(2 * kRows);
  file.read("/values", 0, 2, std::span<double>(all));
  for (PetscInt k = 0; k < kRows; ++k) EXPECT_EQ(all[static_cast<std::size_t>(2 * k)], k == 3 ? 0.0 : k + 0.25);
  std::vector<double> block(2 * static_cast<std::size_t>(order.rows()));
  file.read("/values", order.first(), 2, std::span<double>(block));
  EXPECT_EQ(order.from_table(block, 2), values);
  std::vector<std::uint64_t> word_block(static_cast<std::size_t>(order.rows()));
  file.read("/words", order.first(), 1, std::span<std::uint64_t>(word_block));
  EXPECT_EQ(order.from_table(word_block, 1), words);
}

TEST(Hdf5Reader, RefusesWhatIsNotThere)
{
  const World world;
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  EXPECT_THROW(io::Hdf5Reader(PETSC_COMM_WORLD, scratch.path() / "none.h5"), UserError);
  const std::filesystem::path text = scratch.path() / "text.h5";
  if (world.rank == 0) std::ofstream(text) << "no HDF5";
  MPI_Barrier(PETSC_COMM_WORLD);
  EXPECT_THROW(io::Hdf5Reader(PETSC_COMM_WORLD, text), UserError);
  const std::filesystem::path path = scratch.path() / "table.h5";
  {
    io::Hdf5File file(PETSC_COMM_WORLD, path);
    const std::vector<double> mine(2, 1.0);
    file.dataset("/values", std::span<const double>(mine), 2);
    file.close();
  }
  const io::Hdf5Reader file(PETSC_COMM_WORLD, path);
  std::vector<double> values(4 * static_cast<std::size_t>(world.size));
  EXPECT_THROW(file.read("/nothing", 0, 2, std::span<double>(values)), UserError);
  EXPECT_THROW(file.read("/values", 0, 2, std::span<double>(values)), UserError); // more rows than there are
  EXPECT_THROW(file.read("/values", 0, 1, std::span<double>(values).first(1)), UserError);
  EXPECT_THROW((void)file.text("/", "scene"), UserError);
}
