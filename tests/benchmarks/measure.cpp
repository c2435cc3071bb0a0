#include "measure.h"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <thread>

#include "core/stopwatch.h"
#include "kernels/pkd_traverse.h"

namespace bench {
namespace {

std::string processor() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

}  // namespace

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::vector<double> take_turns(const std::vector<Contender>& contenders, int repetitions) {
  std::vector<std::vector<double>> seconds(contenders.size());
  for (int repetition = -1; repetition < repetitions; ++repetition) {
    for (std::size_t i = 0; i < contenders.size(); ++i) {
      if (contenders[i].prepare) contenders[i].prepare();
      const insitu::Stopwatch watch;
      contenders[i].run();
      if (repetition >= 0) seconds[i].push_back(watch.seconds());
    }
  }
  std::vector<double> medians;
  for (const std::vector<double>& all : seconds) medians.push_back(median(all));
  return medians;
}

Report::Report(int argc, char** argv) {
  std::string command;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    command += (i == 0 ? "" : " ") + (i == 0 ? word.substr(word.find_last_of('/') + 1) : word);
  }
  const std::time_t now = std::time(nullptr);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  context_["date"] = date;
  context_["command"] = command;
  context_["processor"] = processor();
  context_["cores"] = std::thread::hardware_concurrency();
  context_["simd_target"] = insitu::kernels::simd_target_names().front();
  context_["compiler"] = __VERSION__;
}

bool Report::write(const std::string& path) const {
  if (path.empty()) return true;
  std::ofstream file(path);
  file << nlohmann::ordered_json{{"context", context_}, {"results", results_}}.dump(2) << '\n';
  file.close();
  return !file.fail();
}

}  // namespace bench
