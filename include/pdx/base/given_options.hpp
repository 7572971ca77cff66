#pragma once
#include <map>
#include <string>
#include <string_view>

namespace pdx {
/// An option as it was given.
struct GivenOption {
  std::string name;  ///< "-mesh_cells"
  std::string value; ///< "" for a flag
  std::string place; ///< "case.opts, line 3"; "" for the command line
};

/// Takes an option over; of one name the last counts. All options are kept here, PETSc's too: its own store has room
/// for 512 and knows no places.
void give_option(GivenOption option);
void take_back_option(const std::string& name);
/// Null: it was not given.
const GivenOption* given_option(std::string_view name);
/// All of them by name.
const std::map<std::string, GivenOption, std::less<>>& given_options();

/// A message about an option, behind the place where that option was given, if it was in a file.
std::string with_place(const std::string& message);
} // namespace pdx
