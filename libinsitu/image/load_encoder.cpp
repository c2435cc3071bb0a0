#include <dlfcn.h>

#include <mutex>

#include "image/encoder.h"

namespace insitu {
namespace {

std::string reason_of_loader() {
  const char* text = dlerror();  // NOLINT(concurrency-mt-unsafe): every thread has its own
  return text != nullptr ? text : "unknown reason";
}

// RTLD_LOCAL: a host that has other versions of the same libraries keeps its own.
void* load(const std::string& path) { return dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL); }

// The folder of the binary that this code is in, with a slash at its end.
std::string own_folder() {
  static const char here = 0;
  Dl_info info;
  if (dladdr(&here, &info) == 0 || info.dli_fname == nullptr) return "";
  const std::string path = info.dli_fname;
  return path.substr(0, path.find_last_of('/') + 1);
}

}  // namespace

EncodeImage* load_encoder(std::string& error) {
  static std::mutex one_at_a_time;
  static EncodeImage* encoder = nullptr;
  const std::lock_guard lock(one_at_a_time);
  if (encoder != nullptr) return encoder;
  // It stands beside libinsitu, where its RUNPATH leads. In a host with a sanitizer that comes between, dlopen follows
  // the RUNPATH of the sanitizer instead.
  void* library = load(INSITU_ENCODER_LIBRARY);
  if (library == nullptr) {
    error = "the image encoder cannot be loaded: " + reason_of_loader();
    const std::string folder = own_folder();
    if (!folder.empty()) library = load(folder + INSITU_ENCODER_LIBRARY);
    if (library == nullptr) return nullptr;
    error.clear();
  }
  encoder = reinterpret_cast<EncodeImage*>(dlsym(library, "insitu_encode_image"));
  if (encoder == nullptr) error = "the image encoder is of another version: " + reason_of_loader();
  return encoder;
}

}  // namespace insitu
