#include "pdx/pd/cloud_hdf5.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/hdf5_id.hpp"
#include "pdx/base/trial.hpp"
#include "support/scratch_directory.hpp"

#include <array>
#include <csignal>
#include <gtest/gtest.h>
#include <petscsys.h>
#include <unistd.h>

namespace {
using namespace pdx;

/// A file with a dataset `position` of this extent that nobody has filled, and link `volume` to another file.
std::string said_of(const std::filesystem::path& path, hsize_t rows, hsize_t chunk)
{
  {
    const Hdf5Id file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    const std::array<hsize_t, 2> extent{rows, 2}, chunks{chunk, 2};
    const Hdf5Id space(H5Screate_simple(2, extent.data(), nullptr), H5Sclose);
    const Hdf5Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    if (chunk) H5Pset_chunk(list, 2, chunks.data());
    const Hdf5Id set(H5Dcreate2(file, "position", H5T_IEEE_F64LE, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose);
    if (rows == 1) {
      const std::array<double, 2> origin{};
      H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, origin.data());
    }
    H5Lcreate_external("elsewhere.h5", "/volume", file, "volume", H5P_DEFAULT, H5P_DEFAULT);
  }
  try {
    (void)pd::read_cloud_hdf5<2>(path);
    return "";
  } catch (const UserError& error) {
    return error.what();
  }
}
} // namespace

TEST(CloudHdf5, SizesThatNoFileCanHoldAreRefusedBeforeMemoryIsTaken)
{
  const test::ScratchDirectory scratch(PETSC_COMM_WORLD);
  const auto path = scratch.path() / "huge.h5";
  EXPECT_NE(said_of(path, 1000000000000, 0).find("dataset 'position' of '" + path.string() + "' has 1000000000000"),
            std::string::npos);
  EXPECT_NE(said_of(path, 1000000000, 0).find("says it has 2000000000 numbers, more than a file of"),
            std::string::npos);
  EXPECT_NE(said_of(path, 1000000000, 1000).find("says it has 2000000000 numbers"), std::string::npos);
  EXPECT_NE(said_of(path, 1, 0).find("dataset 'volume' of '" + path.string() + "' is in another file"),
            std::string::npos);
}

TEST(Trial, TellsACrashAndAHangFromAnEnd)
{
  EXPECT_EQ(try_apart([] {}, 5), "");
  EXPECT_EQ(try_apart([] { throw UserError("also here"); }, 5), "");
  EXPECT_EQ(try_apart([] { (void)raise(SIGSEGV); }, 5), "HDF5 crashes on it");
  EXPECT_EQ(try_apart([] { pause(); }, 1), "it takes longer than 1 s");
}
