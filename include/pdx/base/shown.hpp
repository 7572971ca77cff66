#pragma once
#include <string>
#include <string_view>

namespace pdx {
/// What a user wrote, as a message shows it: at most `most` characters, control and invisible ones as escapes.
std::string shown(std::string_view text, std::size_t most = 60);
/// A path likewise; of a long one the end.
std::string shown_path(std::string_view path);
/// A message on one line of at most 640 characters: a longer one loses its middle, between words.
std::string as_one_line(std::string_view message);
} // namespace pdx
