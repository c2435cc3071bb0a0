// A step leaves the process that hosts it as it was: arithmetic, locale, folder, signals, streams, environment, limits.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <csignal>
#include <functional>
#include <locale>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "api_test_tools.h"

namespace insitu {
namespace {

using testing::Cloud;
using testing::Context;
using testing::Picture;
using testing::TemporaryFolder;
using testing::works;

constexpr std::uint32_t width = 24;

// Everything that a host does in a life with the library, errors and all; two sets, so that Embree takes part.
Picture live(const std::string& folder, std::uint32_t order = INSITU_ORDER_INDEX, std::uint32_t max_threads = 0) {
  insitu_context context = nullptr;
  insitu_context_desc desc;
  insitu_context_desc_init(&desc);
  desc.max_threads = max_threads;
  EXPECT_EQ(insitu_context_create(&desc, &context), INSITU_OK);
  insitu_context_set_report(context, (folder + "/report.jsonl").c_str());
  const insitu_geometry first = testing::make_particles(context, order);
  const insitu_geometry second = testing::make_particles(context, order);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, width, width, 2);
  Cloud one(5000, 1);
  Cloud two(300, 2);
  one.position.flags = two.position.flags = INSITU_ARRAY_PERMUTABLE;
  one.xyz[4] = 0.0 / 0.0;
  one.xyz[9] = 1e-310;
  two.xyz[5] = 1.0 / 0.0;
  std::vector<double> values(5000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i % 17) * 0.125;
  values[3] = 0.0 / 0.0;
  insitu_array value = insitu_array_records(INSITU_F64, 1, values.data(), values.size(), 0);
  value.flags = INSITU_ARRAY_PERMUTABLE;
  const insitu_attribute attribute = {"heat", &value};
  one.desc.attributes = &attribute;
  one.desc.attribute_count = 1;
  insitu_style style;
  insitu_style_init(&style);
  style.color_by = INSITU_COLOR_ATTRIBUTE;
  style.attribute = "heat";
  EXPECT_TRUE(works(context, insitu_geometry_set_style(context, first, &style)));

  Picture picture;
  for (std::uint64_t step = 0; step < 2; ++step) {
    insitu_step_begin(context, step, 0.5 + static_cast<double>(step));
    insitu_particles_update(context, first, &one.desc);
    insitu_particles_update(context, second, &two.desc);
    insitu_commit(context);
    insitu_render(context, view, image);
    insitu_image_write(context, image, (folder + "/a_{step}_{time}.png").c_str());
    insitu_image_write(context, image, (folder + "/a_{step}_{time}.exr").c_str());
    EXPECT_TRUE(works(context, insitu_step_end(context)));
    picture = testing::read_picture(context, image);
  }
  // A step that fails, in three ways.
  for (const char* name : {"/none/a.png", "/a.jpg", "/{nonsense}.png"}) {
    insitu_step_begin(context, 9, 9.0);
    insitu_commit(context);
    insitu_render(context, view, image);
    EXPECT_NE(insitu_image_write(context, image, (folder + name).c_str()), INSITU_OK);
    EXPECT_NE(insitu_step_end(context), INSITU_OK);
  }
  insitu_context_destroy(context);
  return picture;
}

Picture live() {
  const TemporaryFolder folder;
  return live(folder.path());
}

#if defined(__SSE2__)

TEST(HostState, Mxcsr) {
  const Picture expected = live();
  const unsigned before = _mm_getcsr();
  struct Setting {
    const char* name;
    unsigned mxcsr;
  };
  const Setting settings[] = {
      {"as it comes", 0x1F80},           {"flush to zero", 0x9F80},
      {"denormals are zero", 0x1FC0},    {"both", 0x9FC0},
      {"rounding upwards", 0x5F80},      {"rounding downwards", 0x3F80},
      {"rounding towards zero", 0x7F80}, {"with sticky flags", 0x1FBF},
  };
  for (const Setting& setting : settings) {
    SCOPED_TRACE(setting.name);
    _mm_setcsr(setting.mxcsr);
    const Picture picture = live();
    const unsigned after = _mm_getcsr();
    _mm_setcsr(before);
    // Only the host's own code, as in this test, may raise flags.
    EXPECT_EQ(after & ~0x3Fu, setting.mxcsr & ~0x3Fu);
    EXPECT_EQ(picture, expected);
  }
}

// Call by call: the whole register, sticky flags as well.
TEST(HostState, MxcsrAfterEachCall) {
  const TemporaryFolder folder;
  const std::string name = folder.file("a.png");
  Context context;
  Cloud cloud(500);
  cloud.xyz[3] = 0.0 / 0.0;
  cloud.xyz[6] = 1e-310;
  const insitu_geometry geometry = testing::make_particles(context);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 16, 16);
  double lower[3];
  double upper[3];
  std::vector<std::uint64_t> original(500);
  const std::pair<const char*, std::function<insitu_status()>> calls[] = {
      {"step_begin", [&] { return insitu_step_begin(context, 0, 0.1); }},
      {"update", [&] { return insitu_particles_update(context, geometry, &cloud.desc); }},
      {"commit", [&] { return insitu_commit(context); }},
      {"bounds", [&] { return insitu_geometry_bounds(context, geometry, lower, upper); }},
      {"permutation", [&] { return insitu_particles_permutation(context, geometry, original.data(), 500); }},
      {"fit", [&] { return insitu_view_fit(context, view, 1.5); }},
      {"turn", [&] { return insitu_view_turn(context, view, 30.0); }},
      {"render", [&] { return insitu_render(context, view, image); }},
      {"write", [&] { return insitu_image_write(context, image, name.c_str()); }},
      {"step_end", [&] { return insitu_step_end(context); }},
      {"error", [&] { return insitu_commit(context) == INSITU_ERROR_WRONG_STATE ? INSITU_OK : -1; }},
  };
  for (const unsigned mxcsr : {0x1F80u, 0xFFC0u, 0x1F8Au}) {
    for (const auto& [what, call] : calls) {
      _mm_setcsr(mxcsr);
      const insitu_status status = call();
      const unsigned after = _mm_getcsr();
      _mm_setcsr(0x1F80);
      EXPECT_EQ(after, mxcsr) << what;
      EXPECT_EQ(status, INSITU_OK) << what;
    }
  }
}

#endif

// A host that is killed by its own division by zero is not killed by ours.
TEST(HostState, TrappingFloatingPointExceptions) {
  const Picture expected = live();
  const TemporaryFolder folder;
  std::feclearexcept(FE_ALL_EXCEPT);
  ASSERT_NE(feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW), -1);
  const int before = fegetexcept();
  // Constants are made by the compiler: this test itself computes nothing that traps.
  Context context;
  static const double xyz[9] = {0.0, 0.0, 0.0, __builtin_nan(""), 1.0, 1.0, 1e99, -1e99, __builtin_inf()};
  const insitu_array position = insitu_array_records(INSITU_F64, 3, xyz, 3, 0);
  insitu_particles_desc desc;
  insitu_particles_desc_init(&desc);
  desc.position = &position;
  const insitu_geometry geometry = testing::make_particles(context);
  const insitu_view view = testing::make_view(context);
  const insitu_image image = testing::make_image(context, 16, 16);
  const insitu_status status = run_step(context, geometry, desc, view, image);
  const insitu_status written = insitu_image_write(context, image, folder.file("a.exr").c_str());
  const insitu_status also_written = insitu_image_write(context, image, folder.file("a.png").c_str());
  const int after = fegetexcept();
  fedisableexcept(FE_ALL_EXCEPT);
  EXPECT_EQ(after, before);
  EXPECT_EQ(status, INSITU_OK);
  EXPECT_EQ(written, INSITU_OK);
  EXPECT_EQ(also_written, INSITU_OK);
  EXPECT_EQ(live(), expected);
}

TEST(HostState, RoundingModeOfTheWholeMachine) {
  const Picture expected = live();
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(mode), 0);
    const Picture picture = live();
    const int after = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(after, mode);
    EXPECT_EQ(picture, expected);
  }
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(HostState, Locale) {
  const TemporaryFolder folder;
  const std::locale old_locale = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const std::string old_name = std::setlocale(LC_ALL, nullptr);
  // C functions take a decimal comma from the system, where it has one.
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "nl_NL.UTF-8", "it_IT.UTF-8", "es_ES.UTF-8"})
    if (std::setlocale(LC_ALL, name) != nullptr) break;
  const std::string before = std::setlocale(LC_ALL, nullptr);
  const std::locale cpp_before;
  live(folder.path());
  const std::string after = std::setlocale(LC_ALL, nullptr);
  const bool same = cpp_before == std::locale();
  std::setlocale(LC_ALL, old_name.c_str());
  std::locale::global(old_locale);
  EXPECT_EQ(after, before);
  EXPECT_TRUE(same);
  // Numbers have points, in files and in their names.
  EXPECT_NE(testing::text_of(folder.file("report.jsonl")).find("\"time\":1.5"), std::string::npos);
  EXPECT_FALSE(testing::text_of(folder.file("a_1_1.5.png")).empty());
}

TEST(HostState, WorkingFolderAndUmask) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  const mode_t mask = umask(0027);
  live(".");
  const std::filesystem::path after = std::filesystem::current_path();
  std::filesystem::current_path(before);
  EXPECT_EQ(umask(mask), 0027u);
  EXPECT_EQ(after, std::filesystem::canonical(folder.path()));
  EXPECT_EQ(folder.names().size(), 5u) << "two pictures in each of two steps, and the report";
  for (const std::string& name : folder.names())
    EXPECT_EQ(std::filesystem::status(folder.file(name)).permissions(), std::filesystem::perms(0640)) << name;
}

TEST(HostState, Signals) {
  const auto handlers = [] {
    std::vector<struct sigaction> actions;
    for (int signal = 1; signal < NSIG; ++signal) {
      struct sigaction action;
      std::memset(&action, 0, sizeof action);
      sigaction(signal, nullptr, &action);
      actions.push_back(action);
    }
    return actions;
  };
  const auto mask = [] {
    sigset_t set;
    sigemptyset(&set);
    pthread_sigmask(SIG_BLOCK, nullptr, &set);
    std::vector<int> blocked;
    for (int signal = 1; signal < NSIG; ++signal) blocked.push_back(sigismember(&set, signal));
    return blocked;
  };
  const auto handlers_before = handlers();
  const auto mask_before = mask();
  live();
  const auto handlers_after = handlers();
  EXPECT_EQ(mask(), mask_before);
  for (std::size_t i = 0; i < handlers_before.size(); ++i) {
    EXPECT_EQ(handlers_after[i].sa_handler, handlers_before[i].sa_handler) << "signal " << i + 1;
    EXPECT_EQ(handlers_after[i].sa_flags, handlers_before[i].sa_flags) << "signal " << i + 1;
  }
}

TEST(HostState, NothingIsPrinted) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const TemporaryFolder folder;
  // More threads than there are is what TBB has a warning for.
  for (const std::uint32_t max_threads : {0u, 1u, 200u}) live(folder.path(), INSITU_ORDER_PERMUTE, max_threads);
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(HostState, Environment) {
  const auto variables = [] {
    std::vector<std::string> all;
    for (char** variable = environ; *variable != nullptr; ++variable) all.emplace_back(*variable);
    return all;
  };
  const auto before = variables();
  live();
  EXPECT_EQ(variables(), before);
}

// No file, pipe or device stays open.
TEST(HostState, OpenFiles) {
  const auto open_files = [] {
    return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator());
  };
  live();
  const auto before = open_files();
  live();
  EXPECT_EQ(open_files(), before);
}

// The C library's random numbers are the host's.
TEST(HostState, RandomNumbers) {
  std::srand(1);
  const int expected[2] = {std::rand(), std::rand()};
  std::srand(1);
  EXPECT_EQ(std::rand(), expected[0]);
  live();
  EXPECT_EQ(std::rand(), expected[1]);
}

TEST(HostState, LimitsOfTbb) {
  constexpr auto parallelism = tbb::global_control::max_allowed_parallelism;
  constexpr auto stack = tbb::global_control::thread_stack_size;
  const std::size_t before = tbb::global_control::active_value(parallelism);
  const std::size_t stack_before = tbb::global_control::active_value(stack);
  const TemporaryFolder folder;
  for (const std::uint32_t max_threads : {0u, 1u, 2u, 64u}) {
    live(folder.path(), INSITU_ORDER_INDEX, max_threads);
    EXPECT_EQ(tbb::global_control::active_value(parallelism), before);
    EXPECT_EQ(tbb::global_control::active_value(stack), stack_before);
  }
  // Also while a context with an Embree scene is there, and under a limit of the host's own.
  {
    const tbb::global_control limit(parallelism, 3);
    Context context;
    const insitu_geometry geometries[2] = {testing::make_particles(context), testing::make_particles(context)};
    const Cloud cloud(100);
    insitu_step_begin(context, 0, 0.0);
    for (const insitu_geometry geometry : geometries) insitu_particles_update(context, geometry, &cloud.desc);
    EXPECT_TRUE(works(context, insitu_commit(context)));
    EXPECT_EQ(tbb::global_control::active_value(parallelism), 3u);
    EXPECT_TRUE(works(context, insitu_step_end(context)));
  }
  EXPECT_EQ(tbb::global_control::active_value(parallelism), before);
}

}  // namespace
}  // namespace insitu
