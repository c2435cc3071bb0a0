// melt: a Lennard-Jones crystal melts while libinsitu draws it.
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "options.h"
#include "run.h"

int main(int argc, char** argv) {
  try {
    melt::Options options;
    if (const std::optional<int> code = melt::parse_options(argc, argv, options)) return *code;
    return melt::run(options);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "melt: %s\n", error.what());
    return melt::exit_usage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "melt: %s\n", error.what());
    return melt::exit_incomplete;
  }
}
