#include "image/png_text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace insitu {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::array<unsigned char, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr size_t header_chunk_size = 4 + 4 + 13 + 4;  // length, type, 13 bytes of IHDR, check sum

// CRC-32 as PNG (ISO 3309) asks for it, a bit at a time: the texts of a file are a few hundred bytes.
uint32_t crc32(const unsigned char* bytes, size_t count) {
  uint32_t crc = 0xffffffffu;
  for (size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xedb88320u : 0);
  }
  return ~crc;
}

void append_u32(Bytes& bytes, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<unsigned char>(value >> shift));
}

void append_printable(Bytes& bytes, const std::string& text) {
  for (const char c : text) bytes.push_back(c >= 0x20 && c <= 0x7e ? static_cast<unsigned char>(c) : '?');
}

void append_text_chunk(Bytes& bytes, const TextEntry& text) {
  append_u32(bytes, static_cast<uint32_t>(text.first.size() + 1 + text.second.size()));
  const size_t checked_from = bytes.size();
  append_printable(bytes, "tEXt");
  append_printable(bytes, text.first);
  bytes.push_back(0);
  append_printable(bytes, text.second);
  append_u32(bytes, crc32(bytes.data() + checked_from, bytes.size() - checked_from));
}

}  // namespace

bool insert_png_texts(Bytes& png, const std::vector<TextEntry>& texts) {
  const size_t place = signature.size() + header_chunk_size;
  if (png.size() < place || !std::equal(signature.begin(), signature.end(), png.begin())) return false;
  Bytes chunks;
  for (const TextEntry& text : texts) append_text_chunk(chunks, text);
  png.insert(png.begin() + static_cast<std::ptrdiff_t>(place), chunks.begin(), chunks.end());
  return true;
}

}  // namespace insitu
