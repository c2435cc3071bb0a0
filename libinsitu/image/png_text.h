// Text chunks for PNG files that exist as bytes in memory.
//
// OpenImageIO could write them too, but it keeps every distinct text of its life time in a table that only grows, and
// the texts here are new in every step.
#pragma once

#include <vector>

#include "image/image_metadata.h"

namespace insitu {

// Inserts one tEXt chunk per entry behind the header of the PNG file `png`. Keys have 1 to 79 characters; characters
// outside of printable ASCII become '?'. False, and nothing changed, when `png` does not begin like a PNG file.
bool insert_png_texts(std::vector<unsigned char>& png, const std::vector<TextEntry>& texts);

}  // namespace insitu
