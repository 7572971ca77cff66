#include "pdx/io/sealed_reader.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/hdf5_id.hpp"
#include "pdx/io/agree.hpp"
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/natural_order.hpp"
#include "support/scratch_directory.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <petscsys.h>

namespace pdx::test::sealed_reader {
namespace {
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

/// A file as a run leaves it: tables of all kinds, dealt out over ranks.
std::filesystem::path sealed_file(const std::filesystem::path& directory)
{
  const World world;
  const std::filesystem::path path = directory / "table.h5";
  io::Hdf5File file(PETSC_COMM_WORLD, path.string() + ".part", io::Hdf5File::Mode::sealed);
  const std::vector<double> numbers(40, 0.1 * world.rank), none;
  const std::vector<std::uint64_t> words(30, 1ull << world.rank);
  file.text("/scene", "seven\nrows");
  file.dataset("/numbers", std::span<const double>(numbers), 2);
  file.dataset("/words", std::span<const std::uint64_t>(words), 1);
  file.dataset("/empty", std::span<const double>(none), 4);
  file.close();
  io::rename_durably(PETSC_COMM_WORLD, path.string() + ".part", path);
  return path;
}

std::string bytes_of(const std::filesystem::path& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What opening a file of these bytes says, on every rank alike; "" if nothing is wrong with it.
std::string said_of(const std::filesystem::path& path, const std::string& bytes)
{
  MPI_Barrier(PETSC_COMM_WORLD);
  if (World().rank == 0) std::ofstream(path, std::ios::binary) << bytes;
  MPI_Barrier(PETSC_COMM_WORLD);
  try {
    const io::SealedReader file(PETSC_COMM_WORLD, path);
    return "";
  } catch (const UserError& error) {
    return error.what();
  }
}
} // namespace

TEST(SealedReader, ReadsBackWhatRanksWroteInNaturalOrder)
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
    io::Hdf5File file(PETSC_COMM_WORLD, path.string() + ".part", io::Hdf5File::Mode::sealed);
    file.text("/scene", "seven");
    file.dataset("/values", std::span<const double>(order.to_table(values, 2)), 2);
    file.dataset("/words", std::span<const std::uint64_t>(order.to_table(words, 1)), 1);
    file.close();
  }
  io::rename_durably(PETSC_COMM_WORLD, path.string() + ".part", path);
  const io::SealedReader file(PETSC_COMM_WORLD, path);
  EXPECT_EQ(file.text("/scene"), "seven");
  EXPECT_EQ(file.shape("/values"), (std::array<std::int64_t, 2>{kRows, 2}));
  std::vector<double> all(2 * kRows);
  file.read("/values", 0, 2, std::span<double>(all));
  for (PetscInt k = 0; k < kRows; ++k) EXPECT_EQ(all[static_cast<std::size_t>(2 * k)], k == 3 ? 0.0 : k + 0.25);
  const io::Block block = io::block_of(PETSC_COMM_WORLD, kRows);
  EXPECT_EQ(block.first, order.block().first);
  std::vector<std::uint64_t> mine(static_cast<std::size_t>(block.rows));
  file.read("/words", block.first, 1, std::span<std::uint64_t>(mine));
  for (PetscInt k = 0; k < block.rows; ++k) {
    const PetscInt number = block.first + k; // nobody holds 3
    EXPECT_EQ(mine[static_cast<std::size_t>(k)],
              number == 3 ? 0 : ~std::uint64_t{0} - static_cast<std::uint64_t>(number));
  }
}

TEST(SealedReader, IsAnHdf5FileForOthers)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const std::filesystem::path path = sealed_file(scratch.path());
  if (World().rank) return;
  const Hdf5Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const Hdf5Id set(H5Dopen2(file, "/numbers", H5P_DEFAULT), H5Dclose);
  std::vector<double> values(40 * static_cast<std::size_t>(World().size), -1.0);
  ASSERT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t rank = k / 40;
    EXPECT_EQ(values[k], 0.1 * static_cast<double>(rank));
  }
}

TEST(SealedReader, RefusesEveryDamagedByte)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const std::string whole = bytes_of(sealed_file(scratch.path()));
  const std::filesystem::path path = scratch.path() / "damaged.h5";
  EXPECT_EQ(said_of(path, whole), "");
  int named = 0;
  for (std::size_t at = 0; at < whole.size(); at += at < 200 ? 13 : 97) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 1 << at % 8);
    const std::string said = said_of(path, damaged);
    EXPECT_NE(said.find("cannot read '" + path.string() + "': "), std::string::npos) << "byte " << at;
    named += said.find("dataset /numbers is damaged") != std::string::npos;
  }
  EXPECT_GE(named, 3); // 640 bytes and more
  for (std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{511}, std::size_t{512}, whole.size() / 2, whole.size() - 1})
    EXPECT_NE(said_of(path, whole.substr(0, size)), "") << size << " bytes";
  EXPECT_NE(said_of(path, whole + "x"), "");
}

TEST(SealedReader, SaysWhichVersionWroteWhatItCannotRead)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const std::filesystem::path path = scratch.path() / "old.h5";
  const std::string hdf5 = "\x89HDF\r\n\x1a\n";
  EXPECT_NE(said_of(path, hdf5 + std::string(600, ' ') + "format = 3\nvertices")
                .find("a checkpoint of format 3, of an older version"),
            std::string::npos);
  EXPECT_NE(said_of(path, hdf5 + std::string(600, ' ')).find("an HDF5 file, but no checkpoint"), std::string::npos);
  EXPECT_NE(said_of(path, std::string(600, ' ')).find("no checkpoint of pdxsolve"), std::string::npos);
  std::string later = io::SealHead{io::Seal::kFormat + 1, 512, 0, 0}.text();
  EXPECT_NE(said_of(path, later).find("it has format 10, this version reads 9"), std::string::npos);
}

TEST(SealedReader, RefusesWhatIsNotThere)
{
  const World world;
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  EXPECT_THROW(io::SealedReader(PETSC_COMM_WORLD, scratch.path() / "none.h5"), UserError);
  EXPECT_THROW(io::SealedReader(PETSC_COMM_WORLD, scratch.path()), UserError);
  const io::SealedReader file(PETSC_COMM_WORLD, sealed_file(scratch.path()));
  std::vector<double> values(2000 * static_cast<std::size_t>(world.size));
  EXPECT_THROW(file.read("/nothing", 0, 2, std::span<double>(values)), UserError);
  EXPECT_THROW(file.read("/numbers", 0, 2, std::span<double>(values)), UserError); // more rows than there are
  EXPECT_THROW(file.read("/numbers", -1, 2, std::span<double>(values).first(2)), UserError);
  EXPECT_THROW(file.read("/numbers", 0, 1, std::span<double>(values).first(1)), UserError);
  EXPECT_THROW(file.read("/words", 0, 1, std::span<double>(values).first(1)), UserError); // of another kind
  EXPECT_THROW((void)file.text("/numbers"), UserError);
}

TEST(SealedReader, RefusesNumbersThatAreNotFinite)
{
  const World world;
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const std::filesystem::path path = scratch.path() / "nan.h5";
  {
    io::Hdf5File file(PETSC_COMM_WORLD, path, io::Hdf5File::Mode::sealed);
    const std::vector<double> mine(2, world.rank ? 0.0 : std::numeric_limits<double>::quiet_NaN());
    file.dataset("/values", std::span<const double>(mine), 2);
    file.close();
  }
  const io::SealedReader file(PETSC_COMM_WORLD, path);
  std::vector<double> values(world.rank ? 0 : 2);
  try {
    file.read("/values", 0, 2, std::span<double>(values)); // only rank 0 sees it
    FAIL() << "no exception";
  } catch (const UserError& error) {
    EXPECT_NE(std::string(error.what()).find("dataset /values holds nan"), std::string::npos) << error.what();
  }
}
} // namespace pdx::test::sealed_reader
