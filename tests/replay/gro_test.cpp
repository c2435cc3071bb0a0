#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "atom_names.h"
#include "hybrid36.h"
#include "read_files.h"

namespace replay::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::string two_steps =
    "Water and an ion, t=   1.50000 step= 30\n"
    "    5\n"
    "    1SOL     OW    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434\n"
    "    1SOL    HW1    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791\n"
    "    1SOL    HW2    3   0.177   1.568   1.613 -0.9045 -2.6469  1.3180\n"
    "    1SOL     MW    4   0.130   1.620   1.680  0.0000  0.0000  0.0000\n"
    "99999CA      CA99999 -10.275   1.587   0.275  0.0000  0.0000  0.5000\n"
    "   1.82060   1.82061   1.82062\n"
    "t= 2.0\n"
    "    1\n"
    "    1LYS    1HB    1   1.00000   2.00000  -3.12345\n"
    "   3.00000   4.00000   5.00000   0.00000   0.00000   1.00000   0.00000   1.50000   2.00000\n\n";

TEST(Gro, StepsInAngstrom) {
  Folder folder;
  for (const std::string& path : {folder.write("a", two_steps), folder.write_gz("a.gro.gz", two_steps)}) {
    EXPECT_EQ(detect_format(path), Format::gro);
    const std::vector<Frame> frames = read_all(path);
    ASSERT_EQ(frames.size(), 2u);
    const Frame& first = frames[0];
    EXPECT_EQ(first.time, 1.5);
    EXPECT_EQ(first.step, 30u);
    ASSERT_EQ(first.count(), 5u);
    EXPECT_DOUBLE_EQ(first.position[0], 1.26);
    EXPECT_DOUBLE_EQ(first.position[12], -102.75);
    EXPECT_THAT(values(first, "element"), ElementsAre(8, 1, 1, virtual_site, 20));
    EXPECT_THAT(values(first, "type"), ElementsAre(1, 1, 1, 1, 2));
    EXPECT_THAT(values(first, "residue"), ElementsAre(1, 1, 1, 1, 99999));
    EXPECT_DOUBLE_EQ(values(first, "velocity")[7], -26.469);
    EXPECT_DOUBLE_EQ(values(first, "speed")[4], 5.0);
    EXPECT_DOUBLE_EQ(first.box.edge[2][2], 18.2062);
    const Frame& second = frames[1];
    EXPECT_DOUBLE_EQ(second.position[2], -31.2345);
    EXPECT_EQ(second.find("velocity"), nullptr);
    EXPECT_THAT(values(second, "type"), ElementsAre(3));
    EXPECT_THAT(second.box.edge[1], ElementsAre(10, 40, 0));
    EXPECT_THAT(second.box.edge[2], ElementsAre(15, 20, 50));
  }
}

TEST(Gro, WrongLines) {
  Folder folder;
  ReadOptions options;
  options.format = Format::gro;
  const auto error_with = [&](std::string_view from, std::string_view to) {
    std::string text = two_steps;
    text.replace(text.find(from), from.size(), to);
    return error_of(folder.write("a", text), options);
  };
  EXPECT_EQ(error_with("    5\n", "   x5\n"), "a:2: \"   x5\", expected the number of atoms");
  EXPECT_EQ(error_with("   0.190", "   0.1x0"),
            "a:4: \"   0.1x0\" in the columns 21 to 28, expected the component x of a position");
  EXPECT_EQ(error_with("  0.8085", "        "),
            "a:4: \"        \" in the columns 45 to 52, expected the component x of a velocity");
  EXPECT_THAT(error_with("    5\n", "    6\n"), HasSubstr("a:8: "));
  EXPECT_THAT(error_with("   1.82060", "          "), HasSubstr("expected three or nine numbers"));
  const std::size_t inside = two_steps.find("0.3191");
  EXPECT_EQ(error_of(folder.write("a", two_steps.substr(0, inside)), options),
            "a:4: \"  \" in the columns 53 to 60, expected the component y of a velocity");
  EXPECT_EQ(error_of(folder.write("a", "title\n 3\n"), options), "a:2: the file ends here, expected atom 1 of 3");
}

TEST(AtomNames, ElementsOfForceFieldNames) {
  EXPECT_EQ(element_of_atom("CA", "ALA"), 6);
  EXPECT_EQ(element_of_atom("CA", "CA"), 20);
  EXPECT_EQ(element_of_atom("CA", "CA2+"), 20);
  EXPECT_EQ(element_of_atom("1HB2", "LYS"), 1);
  EXPECT_EQ(element_of_atom("HG", "SER"), 1);
  EXPECT_EQ(element_of_atom("NA", "HEM"), 7);
  EXPECT_EQ(element_of_atom("NA", "NA+"), 11);
  EXPECT_EQ(element_of_atom("FE", "HEM"), 26);
  EXPECT_EQ(element_of_atom("CLA", "CLA"), 17);
  EXPECT_EQ(element_of_atom("SOD", "SOD"), 11);
  EXPECT_EQ(element_of_atom("OW", "SOL"), 8);
  EXPECT_EQ(element_of_atom("MW", "SOL"), virtual_site);
  EXPECT_EQ(element_of_atom("P8", "POPC"), 15);
  EXPECT_EQ(element_of_atom("Q1", "QQQ"), 0);
  EXPECT_EQ(element_of_atom("12", "QQQ"), 0);
}

TEST(Hybrid36, GoesBeyondFiveDigits) {
  const std::pair<std::uint64_t, const char*> known[] = {{0, "    0"},        {99999, "99999"},   {100000, "A0000"},
                                                         {100035, "A000Z"},   {100036, "A0010"},  {43770015, "ZZZZZ"},
                                                         {43770016, "a0000"}, {87440031, "zzzzz"}};
  for (const auto& [number, text] : known) {
    EXPECT_EQ(hybrid36(number), text);
    EXPECT_EQ(parse_hybrid36(text), static_cast<std::int64_t>(number));
  }
  EXPECT_EQ(parse_hybrid36("*****"), std::nullopt);
  EXPECT_EQ(parse_hybrid36("A00a0"), std::nullopt);
  EXPECT_EQ(parse_hybrid36(""), std::nullopt);
}

}  // namespace
}  // namespace replay::test
