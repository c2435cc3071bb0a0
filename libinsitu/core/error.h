// The one exception type of the library: a status of the C API and a text for its user. api/ turns it into both.
#pragma once

#include <stdexcept>
#include <string>

#include "insitu/insitu.h"

namespace insitu {

class Error : public std::runtime_error {
 public:
  Error(insitu_status status, const std::string& text) : std::runtime_error(text), status_(status) {}
  insitu_status status() const { return status_; }

 private:
  insitu_status status_;
};

}  // namespace insitu
