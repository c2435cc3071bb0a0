// The program as a user runs it: what it prints, writes and returns.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "read_files.h"
#include "sample_files.h"

namespace replay::test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

class Program : public ::testing::Test {
 protected:
  Program() {
    folder_.write("water.xyz", "3\n\nO 0 0 0\nH 0.96 0 0\nH -0.24 0.93 0\n");
    folder_.write("steps.dump", step(0) + step(100) + step(200));
  }

  static std::string step(int number) {
    return "ITEM: TIMESTEP\n" + std::to_string(number) +
           "\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n0 9\nITEM: ATOMS id type x y z q\n"
           "1 1 1 1 1 -0.5\n2 2 3 1 nan 0.5\n";
  }

  static std::string read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }

  // In the folder of the test, with small pictures unless the arguments say a size.
  Outcome run(const std::string& arguments) const {
    const std::string out = folder_.path("stdout");
    const std::string err = folder_.path("stderr");
    const std::string small = arguments.find("--size") == std::string::npos ? " --size 40x30 --spp 1 " : " ";
    const std::string command = "cd '" + folder_.path(".") + "' && '" REPLAY_PROGRAM "'" + small + arguments + " >'" +
                                out + "' 2>'" + err + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
  }

  bool exists(const std::string& name) const { return std::filesystem::exists(folder_.path(name)); }

  Folder folder_;
};

TEST_F(Program, WritesAPicture) {
  const Outcome result = run("water.xyz --ao 4 --shadows --out water.png");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(StartsWith("water.png  3 particles, 0 skipped, "), EndsWith(" s\n")));
  EXPECT_THAT(result.err, IsEmpty());
  EXPECT_THAT(read_file(folder_.path("water.png")), StartsWith("\x89PNG"));
}

TEST_F(Program, WritesAPicturePerStepUnderTheNumberOfTheFile) {
  const Outcome result = run("steps.dump --report report.jsonl");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"replay_0.png", "replay_100.png", "replay_200.png"}) EXPECT_TRUE(exists(name)) << name;
  EXPECT_THAT(result.out, HasSubstr("replay_100.png  2 particles, 1 skipped, "));
  const std::string report = read_file(folder_.path("report.jsonl"));
  EXPECT_EQ(std::count(report.begin(), report.end(), '\n'), 3);
}

TEST_F(Program, PlaysSelectedStepsQuietly) {
  const Outcome result = run("steps.dump --steps 1 --quiet --out s_{step:4}.exr");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, IsEmpty());
  EXPECT_TRUE(exists("s_0100.exr"));
  EXPECT_FALSE(exists("s_0000.exr"));
}

TEST_F(Program, NumbersGoOnOverSeveralFiles) {
  const Outcome result = run("water.xyz steps.dump water.xyz");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"replay_0.png", "replay_1.png", "replay_100.png", "replay_200.png", "replay_201.png"}) {
    EXPECT_TRUE(exists(name)) << name;
  }
}

TEST_F(Program, TurnsAroundTheData) {
  const Outcome result = run("water.xyz --turntable 4 --out turn.png");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"turn_000.png", "turn_090.png", "turn_180.png", "turn_270.png"}) {
    EXPECT_TRUE(exists(name)) << name;
  }
  EXPECT_FALSE(read_file(folder_.path("turn_000.png")) == read_file(folder_.path("turn_090.png")));
}

TEST_F(Program, DrawsSnapshotsAndTrajectories) {
  folder_.write("snap", gadget_sample({}));
  folder_.write("run.dcd", dcd_sample({}));
  folder_.write("four.xyz", "4\n\nO 0 0 0\nH 1 0 0\nH 0 1 0\nC 0 0 1\n");
  for (const char* color : {"density", "id", "velocity.y", "type", "mass"}) {
    const Outcome result = run(std::string("snap --order permute --out snap.png --color ") + color);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, StartsWith("snap.png  5 particles, 0 skipped, "));
  }
  EXPECT_EQ(run("four.xyz --trajectory run.dcd --trajectory run.dcd --out t_{step}.png").exit_code, 0);
  for (const char* name : {"t_10.png", "t_15.png", "t_20.png", "t_21.png", "t_23.png"})
    EXPECT_TRUE(exists(name)) << name;
  const Outcome listing = run("--list --trajectory run.dcd four.xyz");
  EXPECT_THAT(listing.out, AllOf(HasSubstr("moved by    run.dcd"), HasSubstr("steps       3, numbered 10 to 20"),
                                 HasSubstr("element          1 to 8 (H C O)")));
  const Outcome wrong = run("water.xyz --trajectory run.dcd");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_EQ(wrong.err, "run.dcd: has 4 particles in a step, expected 3 as \"water.xyz\" has\n");
}

TEST_F(Program, TakesEveryOption) {
  for (const char* options :
       {"--color q --colormap coolwarm --range -1 1", "--color '#4080c0' --background '#202020'",
        "--color type --radius 0.5 --radius-scale 2", "--elements O,H --radius vdw", "--radius auto --view -z",
        "--camera eye=10,5,5,up=0,0,1,fov=50", "--camera eye=10,5,5,at=0,0,0 --orthographic",
        "--view iso --orthographic", "--order copy --threads 1", "--order permute --color q", "--view=-1,0,0.5",
        "--ao 2 --ao-radius 0.5 --background transparent", "--format dump", "--color uniform --quiet"}) {
    const Outcome result = run(std::string("steps.dump ") + options);
    EXPECT_EQ(result.exit_code, 0) << options << '\n' << result.err;
  }
}

TEST_F(Program, TakesMoreSamplesWhereTheyAreNeeded) {
  const auto samples = [this](const std::string& options) {
    std::filesystem::remove(folder_.path("report.jsonl"));
    const Outcome result = run("water.xyz --size 40x30 --spp 4 --report report.jsonl --out water.png " + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string report = read_file(folder_.path("report.jsonl"));
    const std::string key = "\"samples\":";
    return std::stoul(report.substr(report.find(key) + key.size()));
  };
  EXPECT_EQ(samples(""), 4u * 40u * 30u);
  const unsigned long adaptive = samples("--max-samples 64");
  EXPECT_GT(adaptive, 4u * 40u * 30u);
  EXPECT_LT(adaptive, 40u * 40u * 30u);
  EXPECT_LT(samples("--max-samples 64 --pixel-error 0.1"), adaptive);
  EXPECT_THAT(run("water.xyz --pixel-error 0.1").err, HasSubstr("--max-samples"));
  EXPECT_EQ(run("water.xyz --spp 8 --max-samples 4 --size 9x9").exit_code, 1);
}

TEST_F(Program, OrderChangesNothingInThePicture) {
  std::string pixels[3];
  const char* const orders[3] = {"index", "permute", "copy"};
  for (int i = 0; i < 3; ++i) {
    const Outcome result = run(std::string("water.xyz --ao 4 --out water.png --order ") + orders[i]);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    const std::string file = read_file(folder_.path("water.png"));
    pixels[i] = file.substr(std::min(file.find("IDAT"), file.size()));  // what stands before holds the seconds it took
  }
  EXPECT_GT(pixels[0].size(), 100u);
  EXPECT_TRUE(pixels[0] == pixels[1]);
  EXPECT_TRUE(pixels[0] == pixels[2]);
}

TEST_F(Program, ListsWhatIsInAFile) {
  const Outcome result = run("--list steps.dump water.xyz");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out,
              AllOf(HasSubstr("steps.dump: LAMMPS text dump\n"), HasSubstr("3, numbered 0 to 200\n"),
                    HasSubstr("particles   2\n"), HasSubstr("q                -0.5 to 0.5\n"),
                    HasSubstr("z           1 to 1 (3 not finite)\n"), HasSubstr("element          1 to 8 (H O)\n")));
  EXPECT_FALSE(exists("replay_0.png"));
}

TEST_F(Program, PlaysAFileWithoutParticles) {
  folder_.write("none.xyz", "0\n\n");
  const Outcome result = run("none.xyz");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, StartsWith("replay_0.png  0 particles, 0 skipped"));
}

TEST_F(Program, WrongFilesExitWithTwoAndTheLine) {
  folder_.write("short.xyz", "3\n\nO 0 0 0\n");
  folder_.write("garbage.xyz", std::string_view("\x01\x02\0\x04", 4));
  folder_.write("empty.xyz", "");
  folder_.write("huge.xyz", "9000000000000000000\n\nO 0 0 0\n");
  const struct {
    const char* arguments;
    const char* message;
  } cases[] = {
      {"short.xyz", "short.xyz:3: the file ends here, expected particle 2 of 3\n"},
      {"garbage.xyz", "garbage.xyz:1: the line holds binary data, expected a text file\n"},
      {"empty.xyz", "empty.xyz: is empty\n"},
      {"huge.xyz", "huge.xyz:3: the file ends here, expected particle 2 of 9000000000000000000\n"},
      {"missing.xyz", "missing.xyz: there is no such file\n"},
      {".", ".: is a folder, expected a file\n"},
      {"--list short.xyz", "short.xyz:3: the file ends here, expected particle 2 of 3\n"},
  };
  for (const auto& c : cases) {
    const Outcome result = run(c.arguments);
    EXPECT_EQ(result.exit_code, 2) << c.arguments;
    EXPECT_EQ(result.err, c.message);
  }
  EXPECT_FALSE(exists("replay_0.png"));
}

TEST_F(Program, StepsBeforeTheErrorAreKept) {
  folder_.write("cut.dump", step(0) + step(1).substr(0, step(1).rfind("2 2 ")));
  const Outcome result = run("cut.dump");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, EndsWith("cut.dump:21: the file ends here, expected atom 2 of 2\n"));
  EXPECT_TRUE(exists("replay_0.png"));
}

TEST_F(Program, WrongOptionsExitWithTwo) {
  const struct {
    const char* arguments;
    const char* message;
  } cases[] = {
      {"", "FILE is required"},
      {"water.xyz --no-such-option", "--no-such-option"},
      {"water.xyz --color speed", "expected one of element, type"},
      {"water.xyz --radius size", "expected one of element, type"},
      {"water.xyz --colormap rainbow", "viridis"},
      {"water.xyz --format doc", "xyz"},
      {"water.xyz water.xyz --trajectory steps.dump", "--trajectory: expected one FILE"},
      {"water.xyz --order random", "permute"},
      {"water.xyz --range 2 1", "the smaller one first"},
      {"water.xyz --size big", "expected WIDTHxHEIGHT"},
      {"water.xyz --ao -1", "--ao"},
      {"water.xyz --threads -1", "--threads"},
      {"water.xyz --view w", "expected x, -x"},
      {"water.xyz --view x --camera eye=1,2,3", "exclude each other"},
      {"water.xyz --out picture.jpg", "ends in .png or .exr"},
      {"water.xyz --out p_{frame}.png", "is no key"},
      {"water.xyz --atom-style wrong", "expected one of angle"},
      {"water.xyz --steps 5", "selects none of the 1 steps"},
      {"steps.dump --out one.png", "expected {step} in the name"},
      {"steps.dump --radius vdw", "the file names no elements"},
      {"water.xyz --cell", "need the box"},
      {"water.xyz --wrap", "need the box"},
      {"water.xyz --vectors q", "three components, of which there are none"},
      {"steps.dump --bonds auto", "needs radii of elements"},
      {"water.xyz --bonds -1", "the longest bond"},
      {"steps.dump --replicate 2,2", "expected NX,NY,NZ"},
      {"water.xyz --filter speed", "is no condition"},
      {"water.xyz --filter speed:0..1", "expected one of element, type"},
  };
  for (const auto& c : cases) {
    const Outcome result = run(c.arguments);
    EXPECT_EQ(result.exit_code, 2) << c.arguments;
    EXPECT_THAT(result.err, AllOf(StartsWith("insitu-replay: "), HasSubstr(c.message))) << c.arguments;
  }
}

// What is drawn beside the particles takes memory, which the report tells.
TEST_F(Program, BondsArrowsAndTheBoxAreDrawn) {
  folder_.write("moving.xyz",
                "2\nLattice=\"4 0 0 0 4 0 0 0 4\" Properties=species:S:1:pos:R:3:velo:R:3\n"
                "O 0 0 0 1 0 0\nH 0.9 0 0 0 0 2\n");
  const auto owned = [&](const std::string& arguments) {
    const Outcome result = run("moving.xyz --quiet --out a.png --report report.jsonl " + arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << ": " << result.err;
    EXPECT_THAT(result.err, IsEmpty()) << arguments;
    const std::string line = read_file(folder_.path("report.jsonl"));
    const std::size_t at = line.find("\"owned\":");
    std::filesystem::remove(folder_.path("report.jsonl"));
    return at == std::string::npos ? 0 : std::stol(line.substr(at + 8));
  };
  const long plain = owned("");
  EXPECT_GT(plain, 0);
  for (const char* arguments : {"--bonds auto", "--bonds 1.5", "--ball-and-stick 0.25", "--vectors velocity", "--cell"})
    EXPECT_GT(owned(arguments), plain) << arguments;
  EXPECT_GT(owned("--ball-and-stick 0.3 --cell --replicate 2,2,2 --wrap --vectors velocity --vector-scale 0.5"), plain);
}

TEST_F(Program, FiltersLeaveParticlesOut) {
  folder_.write("moving.xyz",
                "4\nProperties=species:S:1:pos:R:3:velo:R:3:id:I:1\n"
                "O 0 0 0 1 0 0 11\nH 1 0 0 0 2 0 12\nH 2 0 0 0 0 3 13\nC 3 0 0 4 0 0 14\n");
  const struct {
    const char* arguments;
    int left_out;
  } cases[] = {{"--filter speed:1.5..3", 2},
               {"--filter velocity.x:0.5..", 2},
               {"--filter 'not element=1'", 2},
               {"--filter 'element=8 or id=13,14'", 1},
               {"--filter speed:2.. --filter 'not id=14'", 2},
               {"--filter box:0.5,-1,-1,2,1,1 --filter plane:-1,0,0,-1.5", 3},
               {"--filter 'id=11 or id=12' --filter 'element=1 or speed:..1'", 2},
               {"--filter id=99", 4}};
  for (const auto& c : cases) {
    const Outcome result = run(std::string("moving.xyz --out a.png ") + c.arguments);
    EXPECT_EQ(result.exit_code, 0) << c.arguments << ": " << result.err;
    EXPECT_THAT(result.out, HasSubstr("4 particles, 0 skipped, " + std::to_string(c.left_out) + " filtered"))
        << c.arguments;
  }
}

TEST_F(Program, ErrorsOfTheLibraryExitWithOne) {
  const Outcome result = run("water.xyz --out missing/picture.png");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, AllOf(StartsWith("insitu-replay: "), HasSubstr("missing")));
}

TEST_F(Program, HelpAndVersionExitWithZero) {
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* text : {"Reading:", "Looks:", "Camera:", "Output:", "Examples:", "--turntable", "Exit codes:"}) {
    EXPECT_THAT(help.out, HasSubstr(text));
  }
  const Outcome version = run("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.out, StartsWith("insitu-replay, libinsitu 0.1.0"));
}

}  // namespace
}  // namespace replay::test
