// cosmo: the cosmic web forms while libinsitu draws it.
#include <cstdio>
#include <exception>
#include <stdexcept>

#include "options.h"
#include "run.h"

int main(int argc, char** argv) {
  try {
    cosmo::Options options;
    if (const std::optional<int> code = cosmo::parse_options(argc, argv, options)) return *code;
    return cosmo::run(options);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "cosmo: %s\n", error.what());
    return cosmo::exit_usage;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cosmo: %s\n", error.what());
    return cosmo::exit_incomplete;
  }
}
