// insitu-replay: plays real data files through insitu.h, step by step.
#include <exception>
#include <iostream>

#include "input_error.h"
#include "listing.h"
#include "options.h"
#include "player.h"
#include "reader.h"

namespace {

enum ExitCode { done = 0, library_failed = 1, wrong_input = 2 };

void list_files(const replay::Options& options) {
  std::uint64_t step = 0;
  for (const std::string& path : options.files) step = replay::print_listing(std::cout, path, options, step);
}

void play_files(const replay::Options& options) {
  replay::Player player(options);
  replay::Frame frame;
  std::uint64_t step = 0;
  bool any = false;
  for (const std::string& path : options.files) {
    const auto reader = replay::open_reader(path, options.read);
    player.begin_file();
    for (; !options.steps.is_behind(step) && reader->next(frame); ++step) {
      if (!options.steps.contains(step)) continue;
      if (!options.elements.empty()) replay::assign_elements(frame, options.elements);
      player.play(frame);
      any = true;
    }
  }
  if (!any) {
    throw replay::UsageError("--steps selects none of the " + std::to_string(step) + " steps of the files");
  }
}

int report(const std::exception& error, ExitCode code) {
  std::cerr << "insitu-replay: " << error.what() << '\n';
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto options = replay::parse_options(argc, argv);
    if (!options) return done;
    options->list ? list_files(*options) : play_files(*options);
    return done;
  } catch (const replay::InputError& error) {
    std::cerr << error.what() << '\n';  // starts with file:line, as editors and terminals understand it
    return wrong_input;
  } catch (const replay::UsageError& error) {
    return report(error, wrong_input);
  } catch (const std::bad_alloc&) {
    std::cerr << "insitu-replay: not enough memory for this step\n";
    return library_failed;
  } catch (const std::exception& error) {
    return report(error, library_failed);
  }
}
