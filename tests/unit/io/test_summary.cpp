#include "pdx/io/summary.hpp"

#include "pdx/base/machine_failure.hpp"
#include "support/scratch_directory.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <petscsys.h>

namespace {
using pdx::io::Summary;
using Json = nlohmann::ordered_json;

Json written(const Summary& summary)
{
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  pdx::io::write_summary(PETSC_COMM_WORLD, scratch.path() / "summary.json", summary);
  std::ifstream file(scratch.path() / "summary.json");
  return Json::parse(file);
}
} // namespace

TEST(Summary, HasEveryKeyOfTheRunContract)
{
  const Json json = written(Summary{});
  for (const char* key : {"case", "version", "petsc_version", "ranks", "status", "message", "wall_seconds", "unknowns",
                          "steps", "newton_iterations", "linear_iterations", "jacobian_assemblies", "factorizations",
                          "bonds_broken", "relocations", "events", "partition", "peak_memory_mb", "results"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (const char* key : {"total", "setup", "solve", "output"}) EXPECT_TRUE(json["wall_seconds"].contains(key)) << key;
  for (const char* key : {"fe", "enriched", "pd", "ghost", "mpm", "total"})
    EXPECT_TRUE(json["unknowns"].contains(key)) << key;
  EXPECT_TRUE(json["results"].is_object());
  EXPECT_TRUE(json["events"].is_object());
  EXPECT_FALSE(json.contains("memory_mb"));
}

TEST(Summary, ValuesComeBack)
{
  Summary summary;
  summary.case_name = "plate_static";
  summary.status = "done";
  summary.wall_seconds = {4.0, 1.0, 2.5, 0.5};
  summary.unknowns = {20402, 8, 12800, 500, 70};
  summary.steps = 3;
  summary.events = {{"pd_force", 7}};
  summary.partition = {120.0, 1.25, {6400}};
  summary.memory_mb = {{"first_step", 80.0}, {"last_step", 81.5}};
  summary.results["j_by_contour"] = {{1e-3, 12.5}, {2e-3, 12.75}};
  const Json json = written(summary);
  EXPECT_EQ(json["case"], "plate_static");
  EXPECT_EQ(json["status"], "done");
  EXPECT_EQ(json["wall_seconds"]["solve"], 2.5);
  EXPECT_EQ(json["unknowns"]["total"], 20402 + 8 + 12800); // ghosts and MPM points are no unknowns
  EXPECT_EQ(json["steps"], 3);
  EXPECT_EQ(json["events"]["pd_force"], 7);
  EXPECT_EQ(json["partition"]["cut"], 120.0);
  EXPECT_EQ(json["partition"]["particles_per_rank"], Json::array({6400}));
  EXPECT_EQ(json["memory_mb"]["last_step"], 81.5);
  EXPECT_EQ(json["results"]["j_by_contour"][1][1], 12.75);
}

TEST(Summary, NumbersThatAreNotFiniteBecomeNull)
{
  Summary summary;
  summary.results["never_happened"] = std::numeric_limits<double>::quiet_NaN();
  summary.wall_seconds.total = std::numeric_limits<double>::infinity();
  const Json json = written(summary);
  EXPECT_TRUE(json["results"]["never_happened"].is_null());
  EXPECT_TRUE(json["wall_seconds"]["total"].is_null());
  EXPECT_TRUE(json["partition"]["cut"].is_null()); // not known on one rank
}

TEST(Summary, ReplacesAnOlderFileAndLeavesNothingElse)
{
  const pdx::test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto path = scratch.path() / "summary.json";
  std::ofstream(path) << std::string(100000, 'x');
  pdx::io::write_summary(PETSC_COMM_WORLD, path, Summary{});
  std::ifstream file(path);
  EXPECT_EQ(Json::parse(file)["status"], "running");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(scratch.path()), {}), 1);
}

TEST(Summary, UnwritablePathIsReported)
{
  EXPECT_THROW(pdx::io::write_summary(PETSC_COMM_WORLD, "/dev/null/summary.json", Summary{}), pdx::MachineFailure);
}

TEST(Memory, PeakIsAtLeastWhatIsResidentNow)
{
  const double now = pdx::io::resident_memory_mb();
  EXPECT_GT(now, 1.0); // MPI alone takes more
  EXPECT_GE(pdx::io::peak_memory_mb(PETSC_COMM_WORLD), 0.99 * now);
}
