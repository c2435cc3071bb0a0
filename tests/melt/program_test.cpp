// The program as its user meets it: options, exit codes, messages, files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct Result {
  int exit_code;
  std::string output;  // of both streams
};

class Melt : public testing::Test {
 protected:
  Melt() {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    folder_ = fs::path(testing::TempDir()) / ("melt_program_" + name);
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Melt() override { fs::remove_all(folder_); }

  // Runs melt with these arguments in a folder of its own.
  Result melt(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.string() + "' && '" MELT_PROGRAM "' " + arguments + " 2>&1";
    std::FILE* const pipe = popen(command.c_str(), "r");
    std::string output;
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) output.append(buffer.data(), n);
    const int status = pclose(pipe);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
  }
  std::vector<std::string> lines(const char* file) const {
    std::ifstream in(folder_ / file);
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }

  fs::path folder_;
};

// A run that takes a moment: 500 atoms.
const std::string tiny = "--atoms 500 --steps 40 --every 20 --size 64x48 --ao 1 ";

TEST_F(Melt, DrawsAndReports) {
  for (const char* const order : {"index", "permute", "copy"}) {
    const Result run = melt(tiny + "--shadows --out " + order + " --order " + order);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("pictures: 3 of 3"));
    for (const char* const file : {"melt_000000.png", "melt_000020.png", "melt_000040.png", "report.jsonl"}) {
      EXPECT_TRUE(fs::exists(folder_ / order / file)) << file;
    }
  }
}

TEST_F(Melt, PicturesLeaveTheEnergiesAlone) {
  EXPECT_EQ(melt(tiny + "--no-images --energy alone.csv").exit_code, 0);
  const std::vector<std::string> alone = lines("alone.csv");
  ASSERT_EQ(alone.size(), 42u);
  EXPECT_EQ(alone[0], "step,kinetic,potential,total,temperature");
  EXPECT_THAT(alone[41], testing::StartsWith("40,"));
  EXPECT_FALSE(fs::exists(folder_ / "melt-images"));
  for (const char* const order : {"index", "permute", "copy"}) {
    EXPECT_EQ(melt(tiny + "--energy drawn.csv --threads 2 --order " + order).exit_code, 0);
    EXPECT_EQ(lines("drawn.csv"), alone) << order;
  }
}

TEST_F(Melt, GoesOnWithoutAPlaceForPictures) {
  std::ofstream(folder_ / "taken") << "a file";
  const Result run = melt(tiny + "--out taken --energy e.csv");
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(run.output, HasSubstr("taken"));
  EXPECT_THAT(run.output, HasSubstr("pictures: 0 of 3"));
  const std::size_t first = run.output.find("melt: no picture");
  ASSERT_NE(first, std::string::npos) << run.output;
  EXPECT_EQ(run.output.find("melt: no picture", first + 1), std::string::npos) << "said more than once";
  EXPECT_EQ(lines("e.csv").size(), 42u);
}

TEST_F(Melt, ExplainsItself) {
  const Result help = melt("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* const option : {"--atoms", "--order", "--energy", "--quick", "Exit codes"}) {
    EXPECT_THAT(help.output, HasSubstr(option));
  }
}

TEST_F(Melt, RefusesWrongOptions) {
  struct Case {
    const char* arguments;
    const char* says;
  };
  for (const Case c :
       {Case{"--size 800", "800x600"}, Case{"--size 5x5", "16 to 16384"}, Case{"--order random", "index"},
        Case{"--atoms -3", "--atoms"}, Case{"--atoms many", "--atoms"}, Case{"--every 0", "--every"},
        Case{"--seed -1", "--seed"}, Case{"--thermostat -5", "--thermostat"}, Case{"--density 0", "--density"},
        Case{"--temperature hot", "--temperature"}, Case{"--bogus", "--bogus"}, Case{"--atoms 32", "too few atoms"},
        Case{"--no-images --energy no/such/folder.csv", "no/such/folder.csv"}}) {
    const Result run = melt(c.arguments);
    EXPECT_EQ(run.exit_code, 2) << c.arguments;
    EXPECT_THAT(run.output, HasSubstr(c.says)) << c.arguments;
    EXPECT_THAT(run.output, Not(HasSubstr("terminate"))) << c.arguments;
  }
}

TEST_F(Melt, StopsWhenTheTimeStepIsTooLong) {
  const Result run = melt("--atoms 500 --steps 400 --thermostat 0 --temperature 50 --dt 0.05 --no-images");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.output, HasSubstr("--dt"));
}

}  // namespace
