#pragma once
#include <string>
#include <string_view>

namespace pdx::options {
/// All options by room with unit, default and allowed values; with words, only those that have all of them in name,
/// room or text, whatever their case. Throws UserError where none has.
std::string help_text(std::string_view words);
/// The same of all options as JSON: a list of objects with name, room, unit, default, allowed and help.
std::string help_json();
} // namespace pdx::options
