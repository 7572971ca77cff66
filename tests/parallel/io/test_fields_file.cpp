#include "pdx/io/snapshot.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/machine_failure.hpp"
#include "support/scratch_directory.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <map>
#include <petscsys.h>
#include <sstream>
#include <stdexcept>

namespace {
using pdx::field::OutputBlock;
using pdx::field::OutputField;
using pdx::io::FieldsFile;
constexpr int kColumns = 4, kRows = 3; // points of the mesh: a 3 x 2 grid of unit cells

struct World {
  int rank = 0, size = 1;
  World()
  {
    MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
    MPI_Comm_size(PETSC_COMM_WORLD, &size);
  }
  /// Points are dealt out in turn, except that the second of three ranks gets none.
  int owner(int natural) const
  {
    const int dealt = natural % size;
    return size == 3 && dealt == 1 ? 2 : dealt;
  }
  /// Points in the order in which they stand in the file.
  std::vector<int> order(int points) const
  {
    std::vector<int> all;
    for (int r = 0; r < size; ++r)
      for (int i = 0; i < points; ++i)
        if (owner(i) == r) all.push_back(i);
    return all;
  }
};

/// The grid of cells; point i lies at (column, row) and has displacement (i, 2 i, 0); cell c has value 100 + c.
OutputBlock mesh(const World& world)
{
  OutputBlock block{"mesh", {}, {}, true, {}, {}};
  OutputField displacement{"displacement [m]", pdx::field::Rank::vector, false, false, {}};
  OutputField use{"use", pdx::field::Rank::scalar, true, true, {}};
  for (int i = 0; i < kColumns * kRows; ++i) {
    if (world.owner(i) != world.rank) continue;
    block.natural_point.push_back(i);
    const int column = i % kColumns, row = i / kColumns;
    block.points.insert(block.points.end(), {1.0 * column, 1.0 * row, 0.0});
    displacement.values.insert(displacement.values.end(), {1.0 * i, 2.0 * i, 0.0});
  }
  const std::vector<int> order = world.order(kColumns * kRows);
  const auto global = [&](int natural) {
    return static_cast<int>(std::find(order.begin(), order.end(), natural) - order.begin());
  };
  for (int c = 0; c < (kColumns - 1) * (kRows - 1); ++c) {
    if (world.owner(c) != world.rank) continue;
    const int corner = c / (kColumns - 1) * kColumns + c % (kColumns - 1);
    for (const int i : {corner, corner + 1, corner + kColumns + 1, corner + kColumns}) block.cells.push_back(global(i));
    use.values.push_back(100.0 + c);
  }
  block.fields = {displacement, use};
  return block;
}

/// n particles; particle i has strain energy density i / 3.
OutputBlock particles(const World& world, int n)
{
  OutputBlock block{"particles", {}, {}, false, {}, {}};
  OutputField energy{"strain energy density [J/m^3]", pdx::field::Rank::scalar, false, false, {}};
  for (int i = 0; i < n; ++i) {
    if (world.owner(i) != world.rank) continue;
    block.natural_point.push_back(i);
    block.points.insert(block.points.end(), {0.1 * i, 0.0, 0.0});
    energy.values.push_back(i / 3.0);
  }
  block.fields = {energy};
  return block;
}

/// What stands in a file, read without MPI.
class Reader {
public:
  explicit Reader(const std::filesystem::path& path) : file_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  ~Reader() { H5Fclose(file_); }
  bool has(const std::string& path) const { return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0; }
  std::array<hsize_t, 2> shape(const std::string& path) const
  {
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT), space = H5Dget_space(set);
    std::array<hsize_t, 2> size{};
    EXPECT_EQ(H5Sget_simple_extent_dims(space, size.data(), nullptr), 2) << path;
    H5Sclose(space);
    H5Dclose(set);
    return size;
  }
  /// Numbers of a dataset, rows one after the other.
  std::vector<double> values(const std::string& path) const
  {
    const auto size = shape(path);
    std::vector<double> all(size[0] * size[1]);
    const hid_t set = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    EXPECT_GE(H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), 0) << path;
    H5Dclose(set);
    return all;
  }
  double number(const std::string& object, const char* name) const
  {
    double value = 0.0;
    const hid_t attribute = H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT);
    EXPECT_GE(H5Aread(attribute, H5T_NATIVE_DOUBLE, &value), 0);
    H5Aclose(attribute);
    return value;
  }
  std::string text(const std::string& object, const char* name) const
  {
    const hid_t attribute = H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t type = H5Aget_type(attribute);
    std::string value(H5Tget_size(type), '\0');
    EXPECT_GE(H5Aread(attribute, type, value.data()), 0);
    H5Tclose(type);
    H5Aclose(attribute);
    value.resize(std::strlen(value.data())); // padded by 0
    return value;
  }

private:
  hid_t file_;
};

/// Runs `look` on rank 0 while the others wait.
template <class Look> void on_first_rank(const World& world, Look look)
{
  MPI_Barrier(PETSC_COMM_WORLD);
  if (world.rank == 0) look();
  MPI_Barrier(PETSC_COMM_WORLD);
}
} // namespace

TEST(FieldsFile, ValuesComeBackByNaturalNumber)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  {
    FieldsFile file(PETSC_COMM_WORLD, scratch.path() / "new" / "run");
    const std::vector<OutputBlock> blocks{mesh(world), particles(world, 7)};
    file.write(0.25, blocks);
  }
  on_first_rank(world, [&] {
    const Reader file(scratch.path() / "new" / "run" / "fields.h5");
    EXPECT_EQ(file.number("/step000000", "time"), 0.25);
    const auto natural = file.values("/step000000/mesh/natural_point");
    const auto u = file.values("/step000000/mesh/displacement");
    const auto x = file.values("/step000000/mesh/points");
    ASSERT_EQ(natural.size(), 12u);
    ASSERT_EQ(u.size(), 36u);
    for (std::size_t p = 0; p < natural.size(); ++p) {
      EXPECT_EQ(u[3 * p], natural[p]);
      EXPECT_EQ(u[3 * p + 1], 2.0 * natural[p]);
      EXPECT_EQ(x[3 * p] + kColumns * x[3 * p + 1], natural[p]);
    }
    const auto numbers = file.values("/step000000/particles/natural_point");
    const auto energy = file.values("/step000000/particles/strain_energy_density");
    ASSERT_EQ(energy.size(), 7u);
    for (std::size_t p = 0; p < energy.size(); ++p) EXPECT_EQ(energy[p], numbers[p] / 3.0);
    EXPECT_EQ(file.text("/step000000/particles/strain_energy_density", "unit"), "J/m^3");
    EXPECT_EQ(file.text("/step000000/mesh/use", "unit"), "");
  });
}

TEST(FieldsFile, CellsPointToTheirCorners)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  {
    FieldsFile file(PETSC_COMM_WORLD, scratch.path());
    const std::vector<OutputBlock> blocks{mesh(world)};
    file.write(0.0, blocks);
  }
  on_first_rank(world, [&] {
    const Reader file(scratch.path() / "fields.h5");
    const auto cells = file.values("/step000000/mesh/cells"), use = file.values("/step000000/mesh/use");
    const auto x = file.values("/step000000/mesh/points");
    ASSERT_EQ(use.size(), 6u);
    for (std::size_t c = 0; c < use.size(); ++c) {
      const int number = static_cast<int>(use[c]) - 100;
      const auto corner = static_cast<std::size_t>(cells[4 * c]), opposite = static_cast<std::size_t>(cells[4 * c + 2]);
      EXPECT_EQ(x[3 * corner], number % (kColumns - 1));
      EXPECT_EQ(x[3 * corner + 1], number / (kColumns - 1));
      EXPECT_EQ(x[3 * opposite] - x[3 * corner], 1.0);
      EXPECT_EQ(x[3 * opposite + 1] - x[3 * corner + 1], 1.0);
    }
  });
}

TEST(FieldsFile, SizesMayChangeAndEmptyBlocksAreLeftOut)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  {
    FieldsFile file(PETSC_COMM_WORLD, scratch.path());
    for (const int n : {5, 0, 1}) {
      const std::vector<OutputBlock> blocks{mesh(world), particles(world, n)};
      file.write(n, blocks);
    }
    EXPECT_EQ(file.steps(), 3);
  }
  on_first_rank(world, [&] {
    const Reader file(scratch.path() / "fields.h5");
    EXPECT_EQ(file.shape("/step000000/particles/points"), (std::array<hsize_t, 2>{5, 3}));
    EXPECT_FALSE(file.has("/step000001/particles"));
    EXPECT_EQ(file.values("/step000002/particles/cells"), (std::vector<double>{0.0}));
    EXPECT_EQ(file.values("/step000000/particles/cells"), (std::vector<double>{0, 1, 2, 3, 4}));
  });
}

TEST(FieldsFile, PairIsReadableWhileTheRunGoesOn)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  FieldsFile file(PETSC_COMM_WORLD, scratch.path());
  const std::vector<OutputBlock> blocks{mesh(world), particles(world, 7)};
  file.write(0.0, blocks);
  file.write(1.0, blocks);
  on_first_rank(world, [&] { // a copy is what a killed run would leave
    std::filesystem::copy_file(scratch.path() / "fields.h5", scratch.path() / "left.h5");
    const Reader left(scratch.path() / "left.h5");
    std::ifstream stream(scratch.path() / "fields.xdmf");
    std::stringstream text;
    text << stream.rdbuf();
    const std::string xdmf = text.str(), mark = "fields.h5:";
    int items = 0;
    for (auto at = xdmf.find(mark); at != std::string::npos; at = xdmf.find(mark, at + 1), ++items) {
      const std::string path = xdmf.substr(at + mark.size(), xdmf.find('<', at) - at - mark.size());
      const auto size = xdmf.rfind("Dimensions=\"", at) + 12;
      std::istringstream said(xdmf.substr(size, xdmf.find('"', size) - size));
      std::array<hsize_t, 2> shape{};
      said >> shape[0] >> shape[1];
      ASSERT_TRUE(left.has(path)) << path;
      EXPECT_EQ(left.shape(path), shape) << path;
    }
    EXPECT_EQ(items, 2 * (4 + 3)); // points, cells, two fields of the mesh; points, cells, one field of particles
  });
}

TEST(FieldsFile, WhatStaysAsItWasIsKeptOnce)
{
  constexpr int kMany = 20000;
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  FieldsFile file(PETSC_COMM_WORLD, scratch.path());
  std::vector<OutputBlock> blocks{particles(world, kMany)};
  std::vector<double> size;
  for (const double time : {0.0, 1.0, 2.0}) {
    if (time == 2.0 && world.rank + 1 == world.size)
      blocks[0].fields[0].values.back() = -1.0; // one of all, on one rank
    file.write(time, blocks);
    MPI_Barrier(PETSC_COMM_WORLD);
    size.push_back(static_cast<double>(std::filesystem::file_size(scratch.path() / "fields.h5")));
  }
  EXPECT_EQ(file.bytes_that_stay(), kMany * (3 * 8 + 4 + 4));
  EXPECT_GE(size[0], kMany * (4 * 8 + 4 + 4));
  EXPECT_LE(size[1] - size[0], 10000);
  EXPECT_GE(size[2] - size[1], kMany * 8);
  EXPECT_LE(size[2] - size[1], kMany * 8 + 10000);
  on_first_rank(world, [&] {
    const Reader left(scratch.path() / "fields.h5");
    for (const char* name : {"points", "natural_point", "cells", "strain_energy_density"}) {
      const std::string path = std::string("/particles/") + name;
      const auto first = left.values("/step000000" + path), third = left.values("/step000002" + path);
      EXPECT_EQ(first, left.values("/step000001" + path)) << path;
      EXPECT_EQ(first == third, name != std::string("strain_energy_density")) << path;
    }
    EXPECT_EQ(left.values("/step000002/particles/strain_energy_density").back(), -1.0);
    EXPECT_EQ(left.text("/step000001/particles/strain_energy_density", "unit"), "J/m^3");
  });
}

TEST(FieldsFile, WrongSizeIsRefusedOnEveryRank)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  FieldsFile file(PETSC_COMM_WORLD, scratch.path());
  std::vector<OutputBlock> blocks{mesh(world)};
  if (world.rank == 0) blocks[0].fields[0].values.pop_back();
  EXPECT_THROW(file.write(0.0, blocks), std::logic_error);
  EXPECT_EQ(file.steps(), 0);
}

TEST(FieldsFile, LeavesItsEventsInTheLog)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const int before = pdx::event_counts()["io_fields"].count;
  FieldsFile file(PETSC_COMM_WORLD, scratch.path());
  const std::vector<OutputBlock> blocks{mesh(world)};
  file.write(0.0, blocks);
  EXPECT_EQ(pdx::event_counts()["io_fields"].count, before + 1);
  EXPECT_GE(pdx::event_counts()["io_xdmf"].count, 1);
}

TEST(FieldsFile, ImpossibleDirectoryIsAUserErrorOnEveryRank)
{
  try {
    const FieldsFile file(PETSC_COMM_WORLD, "/dev/null/run");
    FAIL() << "no exception";
  } catch (const pdx::UserError& error) {
    EXPECT_NE(std::string(error.what()).find("'/dev/null/run': Not a directory"), std::string::npos) << error.what();
  }
}

TEST(Hdf5File, ImpossiblePathIsAUserErrorThatNamesTheReason)
{
  try {
    const pdx::io::Hdf5File file(PETSC_COMM_WORLD, "/nowhere/at/all.h5");
    FAIL() << "no exception";
  } catch (const pdx::UserError& error) {
    EXPECT_STREQ(error.what(), "cannot create '/nowhere/at/all.h5': No such file or directory");
  }
}

TEST(Hdf5File, WritingTheSameDatasetTwiceFailsOnEveryRank)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  pdx::io::Hdf5File file(PETSC_COMM_WORLD, scratch.path() / "a.h5");
  const std::vector<double> slab(2, world.rank);
  file.dataset("/group/a", std::span<const double>(slab), 1);
  EXPECT_THROW(file.dataset("/group/a", std::span<const double>(slab), 1), pdx::MachineFailure);
}

TEST(Hdf5File, AFullDiskIsTheMachinesFaultOnEveryRank)
{
  const World world;
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const std::filesystem::path path = scratch.path() / "fields.h5";
  if (world.rank == 0) std::filesystem::create_symlink("/dev/full", path);
  for (const auto mode : {pdx::io::Hdf5File::Mode::create, pdx::io::Hdf5File::Mode::sealed}) {
    pdx::io::Hdf5File file(PETSC_COMM_WORLD, path, mode);
    const std::vector<double> slab(2, world.rank);
    try {
      file.dataset("/a", std::span<const double>(slab), 1);
      file.flush();
      file.close();
      FAIL() << "no exception";
    } catch (const pdx::MachineFailure& error) {
      EXPECT_EQ(error.what(), "cannot write '" + path.string() + "': No space left on device");
    }
  }
}
