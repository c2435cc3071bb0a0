// Children of a context behind 64-bit ids that tell a stale, foreign or wrong id from a good one:
//   kind (8 bits) | generation (24) | context (8) | slot (24)
// Context numbers come round after 255 contexts; the generations of a context that has a number for the second time
// begin elsewhere, so that ids of the first one stay stale.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/error.h"

namespace insitu {

enum class HandleKind : std::uint8_t { geometry = 1, colormap = 2, view = 3, image = 4 };
const char* handle_kind_name(HandleKind kind);

template <class T>
class HandleTable {
 public:
  // `serial` counts the contexts of the process, from 0.
  HandleTable(HandleKind kind, std::uint32_t serial)
      : kind_(kind),
        context_(static_cast<std::uint8_t>(serial % 255 + 1)),
        first_generation_((serial / 255 * generations_apart + 1) & 0xFFFFFF) {}

  std::uint64_t insert(std::unique_ptr<T> object) {
    std::size_t slot = 0;
    while (slot < slots_.size() && slots_[slot].object) ++slot;
    if (slot == slots_.size()) {
      if (slot >= most_slots) throw Error(INSITU_ERROR_OUT_OF_MEMORY, "too many objects in one context");
      slots_.push_back({nullptr, first_generation_});
    }
    slots_[slot].object = std::move(object);
    return id_of(slot);
  }

  // Throws Error(invalid_handle), saying what is wrong with the id.
  T& get(std::uint64_t id) { return *slots_[slot_of(id)].object; }

  void remove(std::uint64_t id) {
    Slot& slot = slots_[slot_of(id)];
    slot.object.reset();
    slot.generation = (slot.generation + 1) & 0xFFFFFF;
  }

  // `action(id, object)` for all, in the order of creation as far as slots are not used again.
  template <class Action>
  void for_each(Action&& action) {
    for (std::size_t slot = 0; slot < slots_.size(); ++slot)
      if (slots_[slot].object) action(id_of(slot), *slots_[slot].object);
  }

 private:
  static constexpr std::size_t most_slots = 1 << 24;
  static constexpr std::uint32_t generations_apart = 0x10001;  // odd: all 2^24 beginnings occur
  struct Slot {
    std::unique_ptr<T> object;
    std::uint32_t generation;
  };

  std::uint64_t id_of(std::size_t slot) const {
    return std::uint64_t{static_cast<std::uint8_t>(kind_)} << 56 | std::uint64_t{slots_[slot].generation} << 32 |
           std::uint64_t{context_} << 24 | slot;
  }

  std::size_t slot_of(std::uint64_t id) const {
    const std::string name = handle_kind_name(kind_);
    const auto refuse = [](const std::string& text) { throw Error(INSITU_ERROR_INVALID_HANDLE, text); };
    if (id == 0) refuse("no " + name + ": the id is 0");
    if (id >> 56 != static_cast<std::uint64_t>(kind_)) refuse("this id is not that of a " + name);
    if ((id >> 24 & 0xFF) != context_) refuse("this " + name + " belongs to another context");
    const std::size_t slot = id & 0xFFFFFF;
    if (slot >= slots_.size() || !slots_[slot].object || slots_[slot].generation != (id >> 32 & 0xFFFFFF))
      refuse("this " + name + " has been destroyed");
    return slot;
  }

  HandleKind kind_;
  std::uint8_t context_;
  std::uint32_t first_generation_;
  std::vector<Slot> slots_;
};

}  // namespace insitu
