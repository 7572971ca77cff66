#pragma once
#include "pdx/base/error.hpp"

#include <string_view>

namespace pdx::options {
/// What is said to be missing may only be misspelt: throws UserError for a given option that nobody knows and that is
/// all but one which the message names; returns where there is none.
void refuse_misspelt(std::string_view message);

/// The same of what `read` throws.
template <class Read> auto unless_misspelt(Read&& read)
{
  try {
    return read();
  } catch (const UserError& wrong) {
    refuse_misspelt(wrong.what());
    throw;
  }
}

/// Throws UserError for the first given option of something that is not in its list: -bc_right_on, where -bc_names has
/// no right. Call after all our options were read.
void refuse_unlisted();
} // namespace pdx::options
