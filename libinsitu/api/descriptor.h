// Reading structs that begin with their own size, whatever version of the header the caller was compiled with.
#pragma once

#include <algorithm>
#include <cstring>
#include <string>

#include "core/error.h"
#include "insitu/insitu.h"

namespace insitu {

// More than any struct of any version will have: what claims to be longer has not been initialised.
constexpr std::uint32_t longest_struct_bytes = 4096;

// The caller's struct in today's size: members it did not know are zero, which always means the old behaviour. Members
// that this library does not know must be zero.
template <class T>
T copy_in(const T* theirs, const char* name) {
  if (theirs == nullptr) throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string(name) + " is NULL");
  std::uint32_t size = 0;
  std::memcpy(&size, theirs, sizeof size);
  if (size < sizeof size)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string(name) + "::struct_size is 0: call " + name + "_init first");
  if (size > longest_struct_bytes)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string(name) + "::struct_size is " + std::to_string(size) +
                                                   ", which no version has: call " + name + "_init first");
  T ours;
  std::memset(&ours, 0, sizeof ours);
  std::memcpy(&ours, theirs, std::min<std::size_t>(size, sizeof ours));
  const auto* bytes = reinterpret_cast<const unsigned char*>(theirs);
  if (size > sizeof ours && std::any_of(bytes + sizeof ours, bytes + size, [](unsigned char b) { return b != 0; }))
    throw Error(INSITU_ERROR_ABI, std::string(name) + " has members that this version of the library does not know");
  return ours;
}

// The other direction: as much of `ours` as the caller's struct can hold, which keeps its own size.
template <class T>
void copy_out(const T& ours, T* theirs, const char* name) {
  if (theirs == nullptr) throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string(name) + " is NULL");
  std::uint32_t size = 0;
  std::memcpy(&size, theirs, sizeof size);
  if (size < sizeof size)
    throw Error(INSITU_ERROR_INVALID_ARGUMENT, std::string(name) + "::struct_size is 0: call " + name + "_init first");
  std::memcpy(reinterpret_cast<unsigned char*>(theirs) + sizeof size,
              reinterpret_cast<const unsigned char*>(&ours) + sizeof size,
              std::min<std::size_t>(size, sizeof ours) - sizeof size);
}

}  // namespace insitu
