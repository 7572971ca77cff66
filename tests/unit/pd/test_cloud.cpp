#include "pdx/base/error.hpp"
#include "pdx/pd/cloud.hpp"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <hdf5.h>

namespace {
using namespace pdx;

/// A file that goes with this object.
struct File {
  std::filesystem::path path;
  explicit File(const std::string& name, const std::string& text = "")
      : path(std::filesystem::temp_directory_path() / ("pdx_cloud_" + name))
  {
    std::ofstream(path) << text;
  }
  ~File() { std::filesystem::remove(path); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
};

template <int Dim = 2> std::string refusal(const std::string& name, const std::string& text)
{
  const File file(name, text);
  try {
    pd::read_cloud<Dim>(file.path);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Cloud, ReadsColumns)
{
  const File file("good.csv", "x, y,volume,set\r\n0.5,1e-3,2,7\r\n-1,2.25,0.5,-3\n\n");
  const auto cloud = pd::read_cloud<2>(file.path);
  ASSERT_EQ(cloud.points.size(), 2u);
  EXPECT_EQ(cloud.points[0], Vector<2>(0.5, 1e-3));
  EXPECT_EQ(cloud.points[1], Vector<2>(-1.0, 2.25));
  EXPECT_EQ(cloud.volumes, (std::vector<double>{2.0, 0.5}));
  EXPECT_EQ(cloud.sets, (std::vector<Index>{7, -3}));
  const File solid("solid.csv", "x,y,z,volume\n1,2,3,4\n");
  EXPECT_EQ(pd::read_cloud<3>(solid.path).points[0], Vector<3>(1.0, 2.0, 3.0));
  EXPECT_EQ(pd::read_cloud<3>(solid.path).sets, std::vector<Index>{0});
}

TEST(Cloud, SaysWhichLineIsWrong)
{
  EXPECT_NE(refusal("a.csv", "x,y,volume\n1,2,3\n1,2\n").find("line 3"), std::string::npos);
  EXPECT_NE(refusal("b.csv", "x,y,volume\n1,2,3\n1,two,3\n").find("line 3: \"two\""), std::string::npos);
  EXPECT_NE(refusal("c.csv", "x,y,volume\n1,2,3 m\n").find("line 2"), std::string::npos);
  EXPECT_NE(refusal("d.csv", "x,y,z,volume\n1,2,3,4\n").find("x,y,volume"), std::string::npos);
  EXPECT_NE(refusal<3>("e.csv", "x,y,volume\n1,2,3\n").find("x,y,z,volume"), std::string::npos);
  EXPECT_NE(refusal("f.csv", "x,y,volume\n1,2,0\n").find("particle 1"), std::string::npos);
  EXPECT_NE(refusal("g.csv", "x,y,volume\n1,inf,1\n").find("line 2: \"inf\""), std::string::npos);
  EXPECT_NE(refusal("h.csv", "x,y,volume\n").find("none"), std::string::npos);
  EXPECT_NE(refusal("i.txt", "x,y,volume\n1,2,3\n").find("csv"), std::string::npos);
  EXPECT_THROW(pd::read_cloud<2>("no_such_file.csv"), UserError);
}

void write(hid_t file, const char* name, const std::vector<double>& values, std::vector<hsize_t> extent)
{
  const hid_t space = H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr);
  const hid_t set = H5Dcreate2(file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(set);
  H5Sclose(space);
}

TEST(Cloud, ReadsDatasets)
{
  const File file("good.h5");
  const hid_t id = H5Fcreate(file.path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  write(id, "position", {1, 2, 3, 4}, {2, 2});
  write(id, "volume", {5, 6}, {2});
  H5Fclose(id);
  const auto cloud = pd::read_cloud<2>(file.path);
  EXPECT_EQ(cloud.points[1], Vector<2>(3.0, 4.0));
  EXPECT_EQ(cloud.volumes, (std::vector<double>{5.0, 6.0}));
  EXPECT_EQ(cloud.sets, (std::vector<Index>{0, 0}));
  EXPECT_THROW(pd::read_cloud<3>(file.path), UserError);
}

TEST(Cloud, RefusesOtherDatasets)
{
  EXPECT_NE(refusal("text.h5", "x,y,volume\n").find("HDF5"), std::string::npos);
  const File file("bad.hdf5");
  const hid_t id = H5Fcreate(file.path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  write(id, "position", {1, 2, 3, 4}, {2, 2});
  H5Fflush(id, H5F_SCOPE_GLOBAL);
  EXPECT_THROW(pd::read_cloud<2>(file.path), UserError); // no volumes
  write(id, "volume", {5, 6, 7}, {3});
  H5Fclose(id);
  EXPECT_THROW(pd::read_cloud<2>(file.path), UserError); // one too many
}
} // namespace
