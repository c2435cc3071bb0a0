// The program as its user meets it: options, exit codes, messages, files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

struct Result {
  int exit_code;
  std::string output;  // of both streams
};

class CosmoProgram : public testing::Test {
 protected:
  // Runs cosmo with these arguments in a folder of its own.
  Result cosmo(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.path().string() + "' && '" COSMO_PROGRAM "' " + arguments + " 2>&1";
    std::FILE* const pipe = popen(command.c_str(), "r");
    std::string output;
    std::array<char, 4096> buffer;
    for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) output.append(buffer.data(), n);
    const int status = pclose(pipe);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
  }
  std::string text(const std::string& file) const {
    std::ifstream in(folder_.path() / file);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  std::vector<std::string> lines(const std::string& file) const {
    std::ifstream in(folder_.path() / file);
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  bool exists(const std::string& file) const { return fs::exists(folder_.path() / file); }

  insitu::testing::TemporaryFolder folder_;
};

// The number behind "name": of a JSON object, whatever else is in it.
double number_of(const std::string& json, const std::string& name) {
  const std::size_t at = json.find("\"" + name + "\": ");
  if (at == std::string::npos) return -1.0;
  return std::strtod(json.c_str() + at + name.size() + 4, nullptr);
}

// A run that takes a moment.
const std::string tiny = "--particles 16 --side 16 --steps 8 --every 4 --image 64x48 --ao 1 ";

TEST_F(CosmoProgram, DrawsAndReports) {
  for (const std::string order : {"permute", "index", "copy"}) {
    const Result run = cosmo(tiny + "--out " + order + " --order " + order + " --spectrum " + order + ".csv");
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(run.output, HasSubstr("pictures: 3 of 3"));
    for (const char* const file : {"/cosmo_0000.png", "/cosmo_0004.png", "/cosmo_0008.png"}) {
      EXPECT_TRUE(exists(order + file)) << file;
    }
    EXPECT_EQ(lines(order + "/report.jsonl").size(), 3u);
  }
  // The library changes nothing in the physics, in no order.
  EXPECT_EQ(cosmo(tiny + "--no-images --spectrum alone.csv --threads 1").exit_code, 0);
  const std::vector<std::string> alone = lines("alone.csv");
  ASSERT_EQ(alone.size(), 17u);
  EXPECT_EQ(alone[0], "k,modes,power,linear_power");
  for (const char* const order : {"permute", "index", "copy"}) {
    EXPECT_EQ(lines(order + std::string(".csv")), alone) << order;
  }
}

TEST_F(CosmoProgram, SummaryTellsWhatTheRunCost) {
  ASSERT_EQ(cosmo(tiny + "--summary s.json").exit_code, 0);
  const std::string json = text("s.json");
  const auto number = [&](const char* name) { return number_of(json, name); };
  EXPECT_EQ(number("steps"), 8.0);
  EXPECT_EQ(number("pictures"), 3.0);
  EXPECT_EQ(number("mesh_per_side"), 32.0);
  EXPECT_GT(number("library_s"), 0.0);
  EXPECT_LT(number("library_s"), number("total_s"));
  EXPECT_NEAR(number("library_share"), number("library_s") / number("total_s"), 1e-4);
  EXPECT_GE(number("library_s"), number("render_s") + number("write_s"));
  EXPECT_EQ(number("particle_bytes"), 40.0 * 4096);
  EXPECT_EQ(number("host_bytes"), number("particle_bytes") + number("mesh_bytes"));
  EXPECT_EQ(number("extra_bytes"), number("library_peak_bytes") - number("frame_buffer_bytes"));
  EXPECT_NEAR(number("extra_share"), number("extra_bytes") / number("host_bytes"), 1e-4);
  const std::size_t builds = json.find("\"build_s\": [");
  ASSERT_NE(builds, std::string::npos);
  EXPECT_EQ(std::count(json.begin() + static_cast<std::ptrdiff_t>(builds), json.end(), ','), 2);

  // A report line per picture, and what both measure is the same.
  double build_s = 0.0, render_s = 0.0;
  for (const std::string& line : lines("cosmo-images/report.jsonl")) {
    const std::size_t build = line.find("\"build\":");
    const std::size_t render = line.find("\"render\":");
    ASSERT_NE(build, std::string::npos) << line;
    ASSERT_NE(render, std::string::npos) << line;
    build_s += std::strtod(line.c_str() + build + 8, nullptr);
    render_s += std::strtod(line.c_str() + render + 9, nullptr);
    EXPECT_THAT(line, HasSubstr("\"total\":4096"));
    EXPECT_THAT(line, HasSubstr("\"skipped\":0"));
  }
  EXPECT_NEAR(render_s / number("render_s"), 1.0, 0.01);
  EXPECT_GT(build_s, 0.0);
}

TEST_F(CosmoProgram, GoesOnWithoutAPlaceForPictures) {
  std::ofstream(folder_.file("taken")) << "a file";
  const Result run = cosmo(tiny + "--out taken --spectrum p.csv");
  EXPECT_EQ(run.exit_code, 1) << run.output;
  EXPECT_THAT(run.output, HasSubstr("taken"));
  EXPECT_THAT(run.output, HasSubstr("pictures: 0 of 3"));
  const std::size_t first = run.output.find("cosmo: no picture");
  ASSERT_NE(first, std::string::npos) << run.output;
  EXPECT_EQ(run.output.find("cosmo: no picture", first + 1), std::string::npos) << "said more than once";
  EXPECT_EQ(lines("p.csv").size(), 17u);
}

TEST_F(CosmoProgram, TakesOtherUniverses) {
  const Result run = cosmo(tiny +
                           "--no-images --omega-m 1 --omega-lambda 0 --hubble 0.5 --n-s 1 --sigma-8 0.6 --seed 3 "
                           "--a-start 0.05 --a-end 0.5 --mesh 16");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("mesh 16^3, redshift 19 to 1"));
  EXPECT_FALSE(exists("cosmo-images"));
}

TEST_F(CosmoProgram, ExplainsItself) {
  const Result help = cosmo("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* const option : {"--particles", "--order", "--slab", "--summary", "--quick", "Exit codes"}) {
    EXPECT_THAT(help.output, HasSubstr(option));
  }
}

TEST_F(CosmoProgram, RefusesWrongOptions) {
  struct Case {
    const char* arguments;
    const char* says;
  };
  for (const Case c :
       {Case{"--image 800", "1024x1024"}, Case{"--image 5x5", "16 to 16384"}, Case{"--order random", "index"},
        Case{"--color red", "speed"}, Case{"--particles -3", "--particles"}, Case{"--particles many", "--particles"},
        Case{"--particles 13", "multiple of 4"}, Case{"--mesh 30", "multiple of 4"}, Case{"--every 0", "--every"},
        Case{"--slab -1", "--slab"}, Case{"--a-start 1", "scale factor"}, Case{"--omega-b 0.5", "omega_b"},
        Case{"--omega-lambda 5", "does not expand"}, Case{"--sigma-8 0", "--sigma-8"}, Case{"--bogus", "--bogus"},
        Case{"--summary no/such/folder.json", "no/such/folder.json"}}) {
    const Result run = cosmo(c.arguments);
    EXPECT_EQ(run.exit_code, 2) << c.arguments;
    EXPECT_THAT(run.output, HasSubstr(c.says)) << c.arguments;
    EXPECT_THAT(run.output, Not(HasSubstr("terminate"))) << c.arguments;
  }
}

}  // namespace
