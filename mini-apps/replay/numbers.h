// Numbers and words of a text line. Nothing here depends on the locale.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace replay {

// The whole of `text` must be a number; "nan" and "inf" are, and so is "+1". Too large becomes inf, too small 0.
bool parse_number(std::string_view text, double& out);
bool parse_whole(std::string_view text, std::int64_t& out);

using Words = std::vector<std::string_view>;
// Replaces `out` by the words of `line` that blanks and tabs separate; they point into `line`.
void split_words(std::string_view line, Words& out);
std::string_view trimmed(std::string_view text);

bool starts_with_letter(std::string_view text);
bool equal_ignoring_case(std::string_view a, std::string_view b);

}  // namespace replay
