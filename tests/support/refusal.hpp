#pragma once
#include "pdx/base/error.hpp"

#include <string>

namespace pdx::test {
/// What a UserError of `body` says, "none" without one.
template <class Body> std::string refusal(Body&& body)
{
  try {
    body();
  } catch (const UserError& error) {
    return error.what();
  }
  return "none";
}
} // namespace pdx::test
