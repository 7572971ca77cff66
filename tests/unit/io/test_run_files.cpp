#include "pdx/base/error.hpp"
#include "pdx/base/hdf5_id.hpp"
#include "pdx/io/earlier_files.hpp"
#include "pdx/io/hdf5_journal.hpp"
#include "pdx/io/run_lock.hpp"
#include "support/scratch_directory.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <petscsys.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {
using namespace pdx;

std::string content(const std::filesystem::path& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void put(const std::filesystem::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

/// Exit status of what a process of its own does.
template <class Body> int status_of(Body body)
{
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WEXITSTATUS(status);
}
} // namespace

TEST(RunLock, IsThereWhileTheRunLives)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto path = scratch.path() / "run.lock";
  {
    const io::RunLock lock(PETSC_COMM_WORLD, scratch.path());
    const auto owner = nlohmann::json::parse(content(path));
    EXPECT_EQ(owner["process"], getpid());
    EXPECT_GT(owner["start"], 0);
    EXPECT_EQ(owner["since"].get<std::string>().size(), 19u);
    try {
      const io::RunLock second(PETSC_COMM_WORLD, scratch.path());
      FAIL() << "no exception";
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(fmt::format("is in use: process {} on ", getpid())), std::string::npos)
          << error.what();
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(RunLock, OfADeadRunIsTakenOver)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto path = scratch.path() / "run.lock";
  for (const char* left : {"", "{", "[]", R"({"host":"h"})"}) { // killed as it began
    put(path, left);
    const io::RunLock lock(PETSC_COMM_WORLD, scratch.path());
  }
  {
    const io::RunLock lock(PETSC_COMM_WORLD, scratch.path());
    std::filesystem::copy_file(path, scratch.path() / "copy");
  }
  std::filesystem::rename(scratch.path() / "copy", path); // this process's own, but nobody holds the kernel's lock
  const io::RunLock lock(PETSC_COMM_WORLD, scratch.path());
  EXPECT_EQ(nlohmann::json::parse(content(path))["process"], getpid());
}

TEST(EarlierFiles, GoWhereTheyAreRecognised)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto& d = scratch.path();
  const std::string hdf5 = "\x89HDF\r\n\x1a\n rest";
  put(d / "summary.json", "{\n  \"case\": \"a\"}");
  put(d / "history.csv", "step [-],time [s]\n");
  put(d / "fields.h5", hdf5);
  put(d / "fields.xdmf", "<?xml version=\"1.0\" ?>\n<Xdmf Version");
  put(d / "checkpoint.h5", "pdxsolve sealed file, format 4");
  put(d / "checkpoint.h5.part", "half");
  put(d / "crack_path.csv", "tip [-],time [s],x [m],y [m]\n");
  put(d / "notes.txt", "mine");
  std::filesystem::create_symlink("/dev/full", d / "fields.xdmf.part");
  const auto names = [&] {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(d)) all.push_back(entry.path().filename());
    std::ranges::sort(all);
    return all;
  };
  io::clear_earlier_files(d, true);
  EXPECT_EQ(names(), (std::vector<std::string>{"checkpoint.h5", "fields.h5", "fields.xdmf", "fields.xdmf.part",
                                               "history.csv", "notes.txt"}));
  EXPECT_EQ(io::clear_earlier_files(d, false),
            (std::vector<std::string>{"history.csv", "fields.h5", "fields.xdmf", "checkpoint.h5"}));
  EXPECT_EQ(names(), (std::vector<std::string>{"checkpoint_before.h5", "fields.xdmf.part", "notes.txt"}));
  put(d / "history.csv", "time,factor\n0,1\n"); // somebody's table
  put(d / "summary.json", "{\"of\": \"something else\"}");
  EXPECT_TRUE(io::clear_earlier_files(d, false).empty());
  EXPECT_EQ(content(d / "history.csv"), "time,factor\n0,1\n");
}

TEST(Hdf5Journal, OldBytesStayUntilAllNewOnesHaveRoom)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  io::DiskFile disk;
  ASSERT_EQ(disk.open(scratch.path() / "a.h5", O_RDWR | O_CREAT), 0);
  io::Hdf5Journal journal(disk);
  const Hdf5Id access(journal.access(), H5Pclose);
  const hid_t file = H5Fcreate("a.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access);
  ASSERT_GE(file, 0);
  H5Gclose(H5Gcreate2(file, "/step", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_EQ(disk.size(), 0u); // HDF5 itself writes nothing
  ASSERT_GE(H5Fflush(file, H5F_SCOPE_GLOBAL), 0);
  EXPECT_EQ(journal.put_on(disk), 0);
  const std::string whole = content(scratch.path() / "a.h5");
  H5Gclose(H5Gcreate2(file, "/later", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  ASSERT_GE(H5Fflush(file, H5F_SCOPE_GLOBAL), 0);
  EXPECT_FALSE(journal.pieces().empty());
  const int status = status_of([&] { // no file of this process may grow any more
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit most{whole.size(), whole.size()};
    setrlimit(RLIMIT_FSIZE, &most);
    return journal.put_on(disk);
  });
  EXPECT_EQ(status, EFBIG);
  EXPECT_EQ(content(scratch.path() / "a.h5"), whole);
  EXPECT_EQ(journal.put_on(disk), 0);
  EXPECT_GE(H5Fclose(file), 0);
  const Hdf5Id again(H5Fopen((scratch.path() / "a.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  EXPECT_GT(H5Lexists(again, "/later", H5P_DEFAULT), 0);
}
