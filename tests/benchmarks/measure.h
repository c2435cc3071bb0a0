// Medians of interleaved repetitions, and the report that every benchmark leaves.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace bench {

double median(std::vector<double> values);

struct Contender {
  std::string name;
  std::function<void()> prepare;  // not timed; may be empty
  std::function<void()> run;
};

// Seconds of each contender, median of `repetitions` after one round that does not count: all take turns, so that a
// machine that slows down slows all of them down.
std::vector<double> take_turns(const std::vector<Contender>& contenders, int repetitions);

// {"context": {...}, "results": {...}}: date, processor, command line, compiler; numbers by name.
class Report {
 public:
  Report(int argc, char** argv);
  nlohmann::ordered_json& results() { return results_; }
  nlohmann::ordered_json& context() { return context_; }
  // Does nothing for an empty path. False when the file cannot be written.
  bool write(const std::string& path) const;

 private:
  nlohmann::ordered_json context_;
  nlohmann::ordered_json results_;
};

}  // namespace bench
