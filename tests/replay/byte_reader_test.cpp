#include "byte_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "binary_writer.h"
#include "input_error.h"
#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

template <class F>
std::string message_of(const F& f) {
  try {
    f();
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(ByteReader, ReadsBothOrdersFromPlainAndCompressedFiles) {
  Folder folder;
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    BinaryWriter file(order);
    file.put(std::int32_t{-7}).put(2.5).put(std::uint64_t{1} << 40).put(1.5f).put(-1.5f);
    for (const std::string& path : {folder.write("plain", file.text()), folder.write_gz("packed", file.text())}) {
      ByteReader bytes(path);
      bytes.set_order(order);
      EXPECT_EQ(bytes.peek(100), file.text());
      EXPECT_EQ(bytes.size(), 28u);
      EXPECT_EQ(bytes.number<std::int32_t>("a"), -7);
      EXPECT_EQ(bytes.number<double>("b"), 2.5);
      EXPECT_EQ(bytes.size(), 28u);
      EXPECT_EQ(bytes.number<std::uint64_t>("c"), std::uint64_t{1} << 40);
      EXPECT_FALSE(bytes.at_end());
      std::vector<float> floats;
      bytes.numbers(2, "d", floats);
      EXPECT_THAT(floats, ElementsAre(1.5f, -1.5f));
      EXPECT_TRUE(bytes.at_end());
      EXPECT_EQ(bytes.offset(), 28u);
    }
  }
}

TEST(ByteReader, NeverAllocatesForNumbersThatAreNotThere) {
  Folder folder;
  const std::string text(1000, 'x');
  for (const std::string& path : {folder.write("plain", text), folder.write_gz("packed", text)}) {
    ByteReader bytes(path);
    std::vector<double> values;
    EXPECT_THAT(message_of([&] { bytes.numbers(std::uint64_t{1} << 60, "the masses", values); }),
                HasSubstr("the file ends too early, expected the masses at byte"));
    EXPECT_LT(values.capacity(), std::size_t{1} << 20);
  }
}

TEST(ByteReader, SaysWhatIsWrongWithAFile) {
  Folder folder;
  EXPECT_THAT(message_of([&] { ByteReader(folder.path("none")); }), HasSubstr("none: there is no such file"));
  EXPECT_THAT(message_of([&] { ByteReader(folder.write("empty", "")); }), HasSubstr("empty: is empty"));
  EXPECT_THAT(message_of([&] { ByteReader(folder.path(".")); }), HasSubstr("is a folder"));
  BinaryWriter file;
  for (std::uint32_t i = 0; i < 5000; ++i) file.put(i * 2654435761u);
  std::string packed;
  {
    std::ifstream in(folder.write_gz("whole.gz", file.text()), std::ios::binary);
    packed.assign(std::istreambuf_iterator<char>(in), {});
  }
  ByteReader cut(folder.write("cut.gz", packed.substr(0, packed.size() / 2)));
  EXPECT_THAT(message_of([&] { cut.size(); }), HasSubstr("the compressed data are cut off"));
  packed[packed.size() / 2] = static_cast<char>(packed[packed.size() / 2] ^ 0x55);
  packed[packed.size() / 2 + 1] = static_cast<char>(packed[packed.size() / 2 + 1] ^ 0x55);
  ByteReader damaged(folder.write("damaged.gz", packed));
  EXPECT_THAT(message_of([&] { damaged.size(); }), HasSubstr("the compressed data are damaged"));
}

}  // namespace
}  // namespace replay::test
