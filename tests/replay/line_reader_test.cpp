#include "line_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "input_error.h"
#include "numbers.h"
#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> lines_of(const std::string& path) {
  LineReader reader(path);
  std::vector<std::string> lines;
  while (reader.next()) lines.emplace_back(reader.line());
  return lines;
}

std::string failure_of(const std::string& path) {
  try {
    lines_of(path);
  } catch (const InputError& error) {
    return std::string(error.what()).substr(path.size());
  }
  return {};
}

TEST(LineReader, CutsLineEndsOfUnixAndWindows) {
  Folder folder;
  EXPECT_THAT(lines_of(folder.write("a", "one\ntwo\r\n\r\nlast")), ElementsAre("one", "two", "", "last"));
}

TEST(LineReader, PassesOverAByteOrderMark) {
  Folder folder;
  EXPECT_THAT(lines_of(folder.write("a",
                                    "\xEF\xBB\xBF"
                                    "3\n")),
              ElementsAre("3"));
}

TEST(LineReader, ReadsCompressedFiles) {
  Folder folder;
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "line " + std::to_string(i) + '\n';
  const auto lines = lines_of(folder.write_gz("a.gz", text));
  ASSERT_EQ(lines.size(), 100000u);
  EXPECT_EQ(lines.back(), "line 99999");
}

TEST(LineReader, GivesALineAgain) {
  Folder folder;
  LineReader reader(folder.write("a", "one\ntwo\n"));
  reader.next();
  reader.unread();
  reader.next();
  EXPECT_EQ(reader.line(), "one");
  EXPECT_EQ(reader.line_number(), 1u);
}

TEST(LineReader, SaysWhenACompressedFileIsCutOff) {
  Folder folder;
  std::string text;
  for (int i = 0; i < 100000; ++i) text += std::to_string(i * 7919 % 1000003) + '\n';
  const std::string path = folder.write_gz("a.gz", text);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  EXPECT_THAT(failure_of(path), HasSubstr("it is cut off"));
}

TEST(LineReader, SaysWhenACompressedFileIsDamaged) {
  Folder folder;
  std::string text;
  for (int i = 0; i < 100000; ++i) text += std::to_string(i * 7919 % 1000003) + '\n';
  const std::string path = folder.write_gz("a.gz", text);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(2000);
  file.write("\xFF\xFF\xFF\xFF\xFF\xFF\xFF\xFF", 8);
  file.close();
  EXPECT_THAT(failure_of(path), HasSubstr("are damaged"));
}

TEST(LineReader, RefusesWhatIsNoTextFile) {
  Folder folder;
  EXPECT_EQ(failure_of(folder.write("empty", "")), ": is empty");
  EXPECT_EQ(failure_of(folder.write_gz("empty.gz", "")), ": is empty");
  EXPECT_EQ(failure_of(folder.path("missing")), ": there is no such file");
  EXPECT_EQ(failure_of(folder.path(".")), ": is a folder, expected a file");
  EXPECT_EQ(failure_of(folder.write("zero", std::string_view("ab\nc\0d\n", 7))),
            ":2: the line holds binary data, expected a text file");
  EXPECT_THAT(failure_of(folder.write("long", std::string(2000000, 'x'))), HasSubstr(":1: the line has more than"));
}

TEST(Numbers, AreReadWhole) {
  double value = 0.0;
  EXPECT_TRUE(parse_number("-1.5e3", value));
  EXPECT_EQ(value, -1500.0);
  EXPECT_TRUE(parse_number("+2", value));
  EXPECT_EQ(value, 2.0);
  EXPECT_TRUE(parse_number("nan", value));
  EXPECT_TRUE(value != value);
  EXPECT_TRUE(parse_number("-inf", value));
  EXPECT_EQ(value, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(parse_number("1e400", value));
  EXPECT_EQ(value, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(parse_number("1e-400", value));
  EXPECT_EQ(value, 0.0);
  for (const char* text : {"", "+", "+-1", "1.0x", "abc", "1,5", "--1"})
    EXPECT_FALSE(parse_number(text, value)) << text;
  std::int64_t whole = 0;
  EXPECT_TRUE(parse_whole("-12", whole));
  EXPECT_EQ(whole, -12);
  for (const char* text : {"", "1.0", "99999999999999999999"}) EXPECT_FALSE(parse_whole(text, whole)) << text;
}

TEST(Numbers, WordsAreSplitAtBlanksAndTabs) {
  Words words;
  split_words(" a\t bc \r", words);
  EXPECT_THAT(words, ElementsAre("a", "bc"));
  split_words(" \t ", words);
  EXPECT_THAT(words, IsEmpty());
}

}  // namespace
}  // namespace replay::test
