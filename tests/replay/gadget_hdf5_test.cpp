#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;

// Writes groups, arrays and attributes with the HDF5 library.
class Writer {
 public:
  explicit Writer(const std::string& path) : file_(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {}
  ~Writer() { H5Fclose(file_); }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  void group(const char* name) { H5Gclose(H5Gcreate2(file_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }
  template <class T>
  void array(const char* name, hid_t in_file, hid_t in_memory, std::vector<hsize_t> extent,
             const std::vector<T>& data) {
    const hid_t space = H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr);
    const hid_t id = H5Dcreate2(file_, name, in_file, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (!data.empty()) H5Dwrite(id, in_memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data.data());
    H5Dclose(id);
    H5Sclose(space);
  }
  void floats(const char* name, std::vector<hsize_t> extent, const std::vector<float>& data) {
    array(name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, std::move(extent), data);
  }
  // An array that only says how large it is.
  void claim(const char* name, std::vector<hsize_t> extent) {
    const hid_t space = H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr);
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    std::vector<hsize_t> chunk(extent.size(), 3);
    H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
    H5Dclose(H5Dcreate2(file_, name, H5T_IEEE_F32LE, space, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Pclose(creation);
    H5Sclose(space);
  }
  void attribute(const char* object, const char* name, const std::vector<double>& values, hid_t type = H5T_IEEE_F64LE) {
    const hsize_t count = values.size();
    const hid_t space = H5Screate_simple(1, &count, nullptr);
    const hid_t id = H5Acreate_by_name(file_, object, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(id, H5T_NATIVE_DOUBLE, values.data());
    H5Aclose(id);
    H5Sclose(space);
  }

 private:
  hid_t file_;
};

struct Sample {
  double files = 1;
  double total = 2;
  double gas_in_header = 2;
};

// Two gas particles with doubles and big-endian values, three of dark matter at whole places, one black hole whose
// group is there without arrays in the header's count of zero.
void write_sample(const std::string& path, const Sample& what = {}) {
  Writer file(path);
  file.group("Header");
  file.attribute("Header", "NumFilesPerSnapshot", {what.files}, H5T_STD_I32LE);
  file.attribute("Header", "NumPart_ThisFile", {what.gas_in_header, 3, 0, 0, 0, 0}, H5T_STD_U64LE);
  file.attribute("Header", "NumPart_Total", {what.total, 3 * what.files, 0, 0, 0, 0}, H5T_STD_U32BE);
  file.attribute("Header", "NumPart_Total_HighWord", {0, 0, 0, 0, 0, 0}, H5T_STD_U32LE);
  file.attribute("Header", "MassTable", {0, 0.5, 0, 0, 0, 0});
  file.attribute("Header", "Time", {0.75});
  file.attribute("Header", "BoxSize", {10, 20, 30});
  for (const char* group : {"PartType0", "PartType1", "PartType5", "Cells", "PartTypeX"}) file.group(group);
  file.array<double>("PartType0/Coordinates", H5T_IEEE_F64BE, H5T_NATIVE_DOUBLE, {2, 3}, {0.1, 1, 2, 3, 4, 5});
  file.floats("PartType0/Velocities", {2, 3}, {0, 3, 4, 6, 8, 0});
  file.floats("PartType0/Masses", {2}, {1, 8});
  file.floats("PartType0/Density", {2}, {1, 1});
  file.floats("PartType0/Metals", {2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  file.floats("PartType0/Cube", {2, 1, 1}, {1, 2});
  file.array<std::uint64_t>("PartType0/ParticleIDs", H5T_STD_U64LE, H5T_NATIVE_UINT64, {2},
                            {1, (std::uint64_t{1} << 63) + 1});
  file.array<std::int32_t>("PartType1/Coordinates", H5T_STD_I16LE, H5T_NATIVE_INT32, {3, 3},
                           {6, 7, 8, 9, 10, 11, 12, 13, -14});
  file.array<std::int32_t>("PartType1/GroupNr", H5T_STD_I16LE, H5T_NATIVE_INT32, {3}, {-1, 0, 1});
}

void expect_sample(const Frame& frame, std::size_t copies) {
  ASSERT_EQ(frame.count(), 5 * copies);
  EXPECT_EQ(frame.time, 0.75);
  EXPECT_EQ(frame.box.edge[2][2], 30.0);
  for (std::size_t copy = 0; copy < copies; ++copy) {
    const auto of_copy = [&](const char* name) {
      const std::vector<double> all = values(frame, name);
      const auto size = static_cast<std::ptrdiff_t>(all.size() / copies);
      return std::vector<double>(all.begin() + size * static_cast<std::ptrdiff_t>(copy),
                                 all.begin() + size * static_cast<std::ptrdiff_t>(copy + 1));
    };
    EXPECT_EQ(frame.position[15 * copy], 0.1);
    EXPECT_EQ(frame.position[15 * copy + 14], -14.0);
    EXPECT_THAT(of_copy("type"), ElementsAre(0, 0, 1, 1, 1));
    EXPECT_THAT(of_copy("mass"), ElementsAre(1, 8, 0.5, 0.5, 0.5));
    EXPECT_THAT(of_copy("speed"), ElementsAre(5, 10, IsNan(), IsNan(), IsNan()));
    EXPECT_THAT(of_copy("Metals_5"), ElementsAre(5, 10, IsNan(), IsNan(), IsNan()));
    EXPECT_THAT(of_copy("GroupNr"), ElementsAre(0, 0, -1, 0, 1));
    EXPECT_EQ(of_copy("radius")[1], 1.0);
  }
  EXPECT_EQ(std::get<std::vector<std::uint64_t>>(frame.find("id")->scalars)[1], (std::uint64_t{1} << 63) + 1);
  EXPECT_EQ(frame.find("GroupNr")->scalars.index(), 2u);
}

TEST(GadgetHdf5, KindsArraysAndHeader) {
  Folder folder;
  const std::string path = folder.path("snap");
  write_sample(path);
  EXPECT_EQ(detect_format(path), Format::hdf5);
  const auto reader = open_reader(path, {});
  Frame frame;
  ASSERT_TRUE(reader->next(frame));
  expect_sample(frame, 1);
  EXPECT_EQ(reader->remark(), "without Cube");
  EXPECT_FALSE(reader->next(frame));
}

std::string content_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(GadgetHdf5, CompressedFiles) {
  Folder folder;
  write_sample(folder.path("snap"));
  const std::string packed = folder.write_gz("snap.hdf5.gz", content_of(folder.path("snap")));
  EXPECT_EQ(detect_format(packed), Format::hdf5);
  expect_sample(read_all(packed)[0], 1);
}

TEST(GadgetHdf5, SnapshotInPieces) {
  Folder folder;
  for (const char* name : {"snap.0.hdf5", "snap.1.hdf5"}) write_sample(folder.path(name), {2, 4});
  expect_sample(read_all(folder.path("snap.0.hdf5"))[0], 2);
  EXPECT_THAT(error_of(folder.path("snap.1.hdf5")), HasSubstr("expected the first one"));
  write_sample(folder.path("snap.0.hdf5"), {2, 5});
  EXPECT_EQ(error_of(folder.path("snap.0.hdf5")),
            "snap.0.hdf5: the files of the snapshot have 4 particles of type 0, expected 5 by the header");
}

TEST(GadgetHdf5, CoordinatesAlone) {
  Folder folder;
  {
    Writer file(folder.path("a"));
    file.floats("Coordinates", {2, 3}, {1, 2, 3, 4, 5, 6});
    file.floats("Temp", {2}, {7, 8});
  }
  const Frame frame = read_all(folder.path("a"))[0];
  EXPECT_THAT(frame.position, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_THAT(values(frame, "Temp"), ElementsAre(7, 8));
  EXPECT_EQ(frame.find("type"), nullptr);
}

TEST(GadgetHdf5, WrongFiles) {
  Folder folder;
  const std::string path = folder.path("a");
  write_sample(path, {1, 2, 7});
  EXPECT_EQ(error_of(path), "a: the array \"/PartType0/Coordinates\" has 2 rows, expected 7 by the header");
  { Writer(path).group("Other"); }
  EXPECT_THAT(error_of(path), HasSubstr("a: has no group \"PartType0\""));
  { Writer(path).floats("Coordinates", {3, 2}, {1, 2, 3, 4, 5, 6}); }
  EXPECT_THAT(error_of(path), HasSubstr("is no table of numbers with three columns"));
  {
    Writer file(path);
    file.floats("Coordinates", {1, 3}, {1, 2, 3});
    file.floats("Masses", {2}, {1, 2});
  }
  EXPECT_EQ(error_of(path), "a: the array \"/Masses\" has 2 rows, expected 1 as the coordinates have");
  {
    Writer file(path);
    file.group("Header");
    file.attribute("Header", "NumPart_ThisFile", {4});
    file.group("PartType0");
  }
  EXPECT_EQ(error_of(path), "a: has no array \"/PartType0/Coordinates\", but 4 such particles by its header");
  { Writer(path).claim("Coordinates", {std::uint64_t{1} << 40, 3}); }
  EXPECT_EQ(error_of(path),
            "a: the array \"/Coordinates\" has 3298534883328 values by its extent, more than the file can hold");
}

TEST(GadgetHdf5, FilesCutOff) {
  Folder folder;
  write_sample(folder.path("whole"));
  const std::string whole = content_of(folder.path("whole"));
  for (std::size_t length = 9; length < whole.size(); length += 37) {
    const std::string message = error_of(folder.write("a.hdf5", whole.substr(0, length)));
    ASSERT_THAT(message, HasSubstr("a.hdf5: cannot be read as HDF5 (")) << length;
  }
}

}  // namespace
}  // namespace replay::test
