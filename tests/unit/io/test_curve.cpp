#include "pdx/io/curve.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/machine_failure.hpp"
#include "support/scratch_directory.hpp"

#include <array>
#include <fstream>
#include <gtest/gtest.h>
#include <petscsys.h>
#include <stdexcept>

namespace {
using pdx::io::Curve;

std::vector<std::string> lines_of(const std::filesystem::path& path)
{
  std::ifstream file(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}
} // namespace

TEST(Curve, HeaderHasNamesAndUnits)
{
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const Curve curve(PETSC_COMM_WORLD, scratch.path() / "history.csv", {{"load", "-"}, {"reaction", "N"}});
  EXPECT_EQ(lines_of(scratch.path() / "history.csv"), (std::vector<std::string>{"load [-],reaction [N]"}));
}

TEST(Curve, RowIsOnDiskAtOnceAndReadsBackExactly)
{
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  Curve curve(PETSC_COMM_WORLD, scratch.path() / "history.csv", {{"load", "-"}, {"reaction", "N"}});
  const std::array<double, 2> values{0.5, 1.0 / 3.0};
  curve.row(values);
  const auto lines = lines_of(scratch.path() / "history.csv"); // the curve is still open
  ASSERT_EQ(lines.size(), 2u);
  const auto comma = lines[1].find(',');
  EXPECT_EQ(std::stod(lines[1].substr(0, comma)), values[0]);
  EXPECT_EQ(std::stod(lines[1].substr(comma + 1)), values[1]);
}

TEST(Curve, RefusesARowOfTheWrongLength)
{
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  Curve curve(PETSC_COMM_WORLD, scratch.path() / "history.csv", {{"load", "-"}});
  const std::array<double, 2> values{1.0, 2.0};
  EXPECT_THROW(curve.row(values), std::logic_error);
}

TEST(Curve, UnwritablePathIsAUserErrorThatNamesIt)
{
  try {
    const Curve curve(PETSC_COMM_WORLD, "/dev/null/history.csv", {{"load", "-"}});
    FAIL() << "no exception";
  } catch (const pdx::UserError& error) {
    EXPECT_STREQ(error.what(), "cannot create '/dev/null/history.csv': Not a directory");
  }
}

TEST(Curve, AFileThatWasTakenAwayIsTheMachinesFault)
{
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto path = scratch.path() / "history.csv";
  Curve curve(PETSC_COMM_WORLD, path, {{"load", "-"}});
  const std::array<double, 1> values{1.0};
  curve.row(values);
  std::filesystem::remove(path);
  try {
    curve.row(values);
    FAIL() << "no exception";
  } catch (const pdx::MachineFailure& error) {
    EXPECT_EQ(error.what(), "cannot write '" + path.string() + "': No such file or directory");
  }
}
