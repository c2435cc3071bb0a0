#include <dlfcn.h>

#include <mutex>

#include "image/encoder.h"

namespace insitu {
namespace {

std::string reason_of_loader() {
  const char* text = dlerror();
  return text != nullptr ? text : "unknown reason";
}

}  // namespace

EncodeImage* load_encoder(std::string& error) {
  static std::mutex one_at_a_time;
  static EncodeImage* encoder = nullptr;
  const std::lock_guard lock(one_at_a_time);
  if (encoder != nullptr) return encoder;
  // Found beside libinsitu by its RUNPATH. RTLD_LOCAL: a host that has other versions of the same libraries keeps its
  // own.
  void* library = dlopen(INSITU_ENCODER_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    error = "the image encoder cannot be loaded: " + reason_of_loader();
    return nullptr;
  }
  encoder = reinterpret_cast<EncodeImage*>(dlsym(library, "insitu_encode_image"));
  if (encoder == nullptr) error = "the image encoder is of another version: " + reason_of_loader();
  return encoder;
}

}  // namespace insitu
